# SPDX-License-Identifier: GPL-3.0-or-later
"""Base class of passes, and Frame: the input of passes for one sample of an image."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias, TypeVar

import moderngl
import numpy as np

from ..resource_types import Resource, Target, targets_of
from ..resources import TILE_SIZE
from ..sampling.pixel_grid import PixelGrid
from ..scene import Change, Scene, View
from ..settings import Settings
from .gl.buffer_texture import SceneRecords
from .gl.context import Device
from .gl.shader_compiler import Part, ProgramSource, compile_program, program_of, split_parts
from .gl.shader_records import INSTANCE
from .submission import Submission

if TYPE_CHECKING:
    from .estimators import Estimator
    from .graph import Graph
    from .materials.point_graphs import PointGraphs

T = TypeVar("T")

#: An input of a pass: a resource, a component of the scene or view, or a setting by its path, like "shadow.bias".
Input: TypeAlias = Resource[Any] | Change | str


def has_doubled(count: int) -> bool:
    """Whether the number of samples is a power of two: 1, 2, 4, 8, …"""
    return count > 0 and count & (count - 1) == 0


class Schedule(Enum):
    """The samples in which a pass is executed, if its inputs have changed."""

    EVERY = "each sample"
    FIRST = "the first sample"
    #: Not at 2: with so few samples, shadow rays predict visibility worse than probe rays.
    DOUBLING = "the first sample, and whenever 4, 8, 16, … samples are done"

    def is_due(self, sample: int) -> bool:
        """Whether the pass is due in the sample of this index, from 0."""
        doubling = self is Schedule.DOUBLING and sample > 2 and has_doubled(sample)
        return self is Schedule.EVERY or sample == 0 or doubling


class UndeclaredResourceError(RuntimeError):
    """A pass reads or makes a resource that it has not declared: a programming error."""


@dataclass
class Frame:
    """The input of passes for one sample of an image. `frame[X]` is a resource that the current pass has declared."""

    device: Device
    scene: Scene
    view: View
    settings: Settings
    sample: int
    corrects: bool  # whether predictions are corrected: always but for the first picture
    low_latency: bool  # whether the first sample is finished earlier
    anchor: np.ndarray  # (3,) float64 world
    graph: Graph
    estimators: tuple[Estimator, ...]
    counts: dict[str, int]
    warnings: set[str]  # sentences for the user
    grid: PixelGrid  # positions of samples in pixels
    submission: Submission
    uniforms: moderngl.Buffer
    step: Pass | None = None  # the current pass: only its declared resources are accessible; None: all resources are

    def __getitem__(self, resource: Resource[T]) -> T:
        """Raises UndeclaredResourceError, and KeyError if no pass has made the resource."""
        self._check(resource, self.step is None or resource in self.step.readable)
        return self.graph[resource]

    def get(self, resource: Resource[T]) -> T | None:
        """As frame[resource], or None if no pass has made the resource."""
        self._check(resource, self.step is None or resource in self.step.readable)
        return self.graph.get(resource)

    def __setitem__(self, resource: Resource[T], content: T) -> None:
        """Store an output of the pass. Raises UndeclaredResourceError."""
        self._check(resource, self.step is None or resource in self.step.outputs)
        self.graph[resource] = content

    def _check(self, resource: Resource[Any], declared: bool) -> None:
        if not declared:
            raise UndeclaredResourceError(f"{self.step} has not declared {resource}")
        if not self.corrects and self.step is not None and resource in self.step.feedback:
            raise UndeclaredResourceError(f"{self.step} reads {resource} before the first picture has made it")

    def framebuffer(self, *targets: Target) -> moderngl.Framebuffer:
        """A framebuffer of outputs of the pass; its depth may be an input. Raises UndeclaredResourceError."""
        for target in targets:
            allowed = self.step is None or target in (self.step.readable if target.is_depth else self.step.outputs)
            self._check(target, allowed)
        return self.graph.targets.framebuffer(*targets)

    def copy_target(self, into: Target, source: Target) -> None:
        """Copy a target of the image's size to an output."""
        self._check(source, self.step is None or source in self.step.readable)
        self.device.gl.copy_framebuffer(self.framebuffer(into), self.graph.targets.framebuffer(source))

    def read(self, target: Target) -> np.ndarray:
        """(H,W,components) float32 of a target of floats, bottom row first. Waits for the GPU."""
        self._check(target, self.step is None or target in self.step.readable)
        return self.graph.targets.read(target)

    def allocate(self, target: Target, size: tuple[int, int]) -> None:
        """Allocate an output whose size is not a fraction of the image's."""
        self._check(target, self.step is None or target in self.step.outputs)
        self.graph.targets.allocate(target, size)

    def reserve(self, target: Target, size: tuple[int, int]) -> None:
        """As `allocate`, but keep a texture that is larger: new memory pages are slow."""
        self._check(target, self.step is None or target in self.step.outputs)
        self.graph.targets.reserve(target, size)

    def is_neutral(self, target: Target) -> bool:
        """Whether no pass has made a target, so its texture is neutral."""
        return target not in self.graph.targets.sizes

    @property
    def scene_records(self) -> SceneRecords:
        """The buffer of the scene's tables. A pass writes a table and stores it as an output, or in one."""
        return self.graph.scene_records

    @property
    def size(self) -> tuple[int, int]:
        """Size of the image, px."""
        return self.view.width, self.view.height

    @property
    def tiles(self) -> tuple[int, int]:
        """Columns and rows of tiles that cover the image."""
        return -(-self.view.width // TILE_SIZE), -(-self.view.height // TILE_SIZE)

    @cached_property
    def casts_shadows(self) -> bool:
        """Whether any light and any instance cast shadows."""
        return bool(
            self.settings.shadow.enabled
            and self.scene.lights.casts_shadow.any()
            and self.scene.instances.casts_shadow.any()
        )

    @cached_property
    def traces_shadows(self) -> bool:
        """Whether shadow rays are traced that can hit anything."""
        return self.casts_shadows and any(estimator.traces_rays for estimator in self.estimators)

    @property
    def is_adaptive(self) -> bool:
        """Whether tiles with less noise have fewer samples."""
        return self.settings.shortcuts and all(estimator.adaptive for estimator in self.estimators)

    def shared_resource(self, make: Callable[..., T], *arguments: Any) -> T:
        """`make(device, *arguments)`, shared by all renderers that use it with the same components of the scene."""
        key = make, *arguments
        resource: Any = self.device.shared.get(key)
        if resource is None:
            resource = self.device.shared[key] = make(self.device, *arguments)
            self.counts["bytes_uploaded"] += resource.bytes
        return resource

    @cached_property
    def states(self) -> Mapping[Change, object]:
        """Values that identify the states of components of scene and view: equal while these are unchanged."""
        view = self.view
        return {
            Change.MESHES: self.scene.meshes,
            Change.INSTANCES: (self.scene.instances, self.anchor.tobytes()),
            Change.MATERIALS: (self.scene.materials, self.scene.images, self.scene.graphs),
            Change.NORMALS: (
                (self.scene.materials, self.scene.images)
                if any(graph.changes_normals for graph in self.scene.graphs)
                else None
            ),
            Change.EMISSION_VIEW: (
                (view.clip_from_view.tobytes(), view.view_from_world.tobytes())
                if any(graph.emits and graph.reads_view for graph in self.scene.graphs)
                else None
            ),
            Change.GLOSS: (self.scene.has_gloss, self.scene.traces_graphs),
            Change.LIGHTS: (
                self.scene.lights,
                self.scene.light_profiles,
                self.scene.light_images,
                self.anchor.tobytes(),
            ),
            Change.WORLD: self.scene.world,
            Change.VIEW: (
                view.clip_from_view.tobytes(),
                view.view_from_world.tobytes(),
                (view.width, view.height, view.filter_width, view.transparent),
                self.anchor.tobytes(),
            ),
            Change.PIXEL_GRID: (self.sample // len(self.grid.subpixel_offsets), len(self.grid.subpixel_offsets)),
            Change.SAMPLE: (self.sample, self.corrects),
        }


class Pass:
    """A pass. Its row in the profile has the name of its class; its shaders lie beside its module.

    It is executed if its schedule is due and any of its inputs has changed. `feedback` are resources of the previous
    sample, or of the first picture. `outputs` maps each output to the inputs that only it depends on.
    """

    schedule: ClassVar[Schedule] = Schedule.EVERY
    inputs: ClassVar[tuple[Input, ...]] = ()
    feedback: ClassVar[tuple[Resource[Any], ...]] = ()
    outputs: ClassVar[Mapping[Resource[Any], tuple[Input, ...]]] = {}
    readable: ClassVar[frozenset[Resource[Any]]] = frozenset()
    #: Whether the sample's index is an input.
    differs_each_sample: ClassVar[bool] = False
    #: Targets that are allocated before the pass is executed, targets among its inputs, and targets among its feedback.
    sized_outputs: ClassVar[tuple[Target, ...]] = ()
    read_targets: ClassVar[tuple[Target, ...]] = ()
    feedback_targets: ClassVar[tuple[Target, ...]] = ()
    #: Of each output, the inputs that only other outputs depend on, by index.
    unrelated: ClassVar[Mapping[Resource[Any], frozenset[int]]] = {}

    def __init_subclass__(cls) -> None:
        resources = (each for each in cls.inputs if isinstance(each, Resource))
        cls.readable = frozenset((*resources, *cls.feedback, *cls.outputs))
        cls.differs_each_sample = Change.SAMPLE in cls.inputs
        cls.sized_outputs = tuple(each for each in cls.outputs if isinstance(each, Target) and each.divisor)
        cls.read_targets, cls.feedback_targets = targets_of(cls.inputs), targets_of(cls.feedback)
        exclusive = {each for inputs in cls.outputs.values() for each in inputs}
        cls.unrelated = {
            output: frozenset(index for index, each in enumerate(cls.inputs) if each in exclusive - set(own_inputs))
            for output, own_inputs in cls.outputs.items()
        }

    def __init__(self, device: Device):
        self.device = device

    def __repr__(self) -> str:
        return type(self).__name__

    def needed(self, frame: Frame) -> bool:
        """Whether the image would differ without this pass."""
        return True

    def execute(self, frame: Frame) -> None:
        """Make the outputs. Those that are not targets are stored last, because the pass may raise Cancelled."""
        raise NotImplementedError

    def tile_program(self, *parts: Part, suffix: str = "", **constants: int | float) -> moderngl.Program:
        """The program of this pass's shader file for drawing.draw_tiles; see tile_source."""
        return program_of(self.device, self.tile_source(*parts, suffix=suffix, **constants))

    @classmethod
    def tile_source(cls, *parts: Part, suffix: str = "", **constants: int | float) -> ProgramSource:
        """The source of such a program. `suffix`: see shader_name; `parts`: what the file includes."""
        stages = "glsl/tiles.vert", f"{cls.shader_name(suffix)}.frag"
        includes, records = split_parts(parts)
        return ProgramSource((*stages, *includes), records, (("tile_size", TILE_SIZE), *constants.items()))

    def instance_program(self, surfaces: PointGraphs) -> moderngl.Program:
        """The program of this pass's shader file that draws instances of such surfaces."""
        stages = "glsl/instances.vert", f"{self.shader_name()}.frag"
        constants = {"reversed_depth": int(self.device.reversed_depth), **surfaces.constants}
        records = surfaces.records or (INSTANCE,)
        return compile_program(self.device, *stages, *surfaces.includes, records=records, **constants)

    def full_screen_program(self, *parts: Part, suffix: str = "", **constants: int | float) -> moderngl.VertexArray:
        """A full-screen triangle with this pass's shader file, see tile_source."""
        stages = "glsl/full_screen.vert", f"{self.shader_name(suffix)}.frag"
        includes, records = split_parts(parts)
        program = compile_program(self.device, *stages, *includes, records=records, **constants)
        return self.device.gl.vertex_array(program, [])

    @classmethod
    def shader_name(cls, suffix: str = "") -> str:
        """Path of a shader file without its extension: this pass's module, or module_suffix."""
        return shader_name(cls.__module__, suffix)


@cache
def shader_name(module: str, suffix: str) -> str:
    """See Pass.shader_name."""
    path = module.rpartition(".gpu.")[2].replace(".", "/")
    return "_".join(filter(None, (path, suffix)))


def outputs(*resources: Resource[Any]) -> dict[Resource[Any], tuple[Input, ...]]:
    """Outputs that depend on all inputs of a pass."""
    return dict.fromkeys(resources, ())
