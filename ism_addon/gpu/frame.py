# SPDX-License-Identifier: GPL-3.0-or-later
"""What a pass is, and what it is handed: one sample of a picture."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias, TypeVar

import moderngl
import numpy as np

from ..resource_types import Resource, Target
from ..resources import TILE_SIZE
from ..sampling import PixelGrid
from ..scene import Change, Scene, View
from ..settings import Settings
from .gl.context import Device
from .gl.shader_compiler import compile_program
from .gl.shader_records import Record
from .submission import Submission

if TYPE_CHECKING:
    from .estimators import Estimator
    from .graph import Graph

T = TypeVar("T")

#: What a pass depends on: a resource, a part of the scene or the view, or a setting by its path, like "shadow.bias".
Input: TypeAlias = Resource[Any] | Change | str


def has_doubled(count: int) -> bool:
    """Whether so many samples are twice as many as when that was last so: 1, 2, 4, 8, …"""
    return count > 0 and count & (count - 1) == 0


class Schedule(Enum):
    """The samples before which a pass is due, if its inputs are new."""

    EVERY = "each sample"
    FIRST = "the first sample"
    #: From 4 on: before that, the pixels' own rays say less than the probe rays.
    DOUBLING = "the first sample, and whenever 4, 8, 16, … samples are done"

    def is_due(self, sample: int) -> bool:
        """Before the sample of this index, counted from 0."""
        return (
            self is Schedule.EVERY or sample == 0 or (self is Schedule.DOUBLING and sample > 2 and has_doubled(sample))
        )


class UndeclaredResourceError(RuntimeError):
    """A pass reads or makes what it has not declared. A fault of the pass, which no scene can cause."""


@dataclass
class Frame:
    """One sample of one picture, as the passes see it. `frame[X]` is a resource that the pass at work has declared."""

    device: Device
    scene: Scene
    view: View
    settings: Settings
    sample: int
    anchor: np.ndarray  # (3,) float64 world
    graph: Graph
    estimators: tuple[Estimator, ...]
    counts: dict[str, int]
    grid: PixelGrid  # where in the pixels samples lie
    submission: Submission
    uniforms: moderngl.Buffer
    step: Pass | None = None  # at work; None may read and make anything

    def for_pass(self, step: Pass) -> Frame:
        """The same frame with what this pass has declared, and no more."""
        own = copy(self)
        own.step = step
        return own

    def __getitem__(self, resource: Resource[T]) -> T:
        """Raises UndeclaredResourceError, and KeyError for what no pass has made."""
        self._check(resource, self.step is None or resource in self.step.readable)
        return self.graph[resource]

    def get(self, resource: Resource[T]) -> T | None:
        """The same, or None for what no pass has made."""
        self._check(resource, self.step is None or resource in self.step.readable)
        return self.graph.get(resource)

    def __setitem__(self, resource: Resource[T], content: T) -> None:
        """Hand on what a pass has made. Raises UndeclaredResourceError."""
        self._check(resource, self.step is None or resource in self.step.outputs)
        self.graph[resource] = content

    def _check(self, resource: Resource[Any], declared: bool) -> None:
        if not declared:
            raise UndeclaredResourceError(f"{self.step} has not declared {resource}")
        if self.sample == 0 and self.step is not None and resource in self.step.feedback:
            raise UndeclaredResourceError(f"{self.step} reads {resource} before the first sample has made it")

    def framebuffer(self, *targets: Target) -> moderngl.Framebuffer:
        """To draw into outputs of the pass. Raises UndeclaredResourceError."""
        for target in targets:
            self._check(target, self.step is None or target in self.step.outputs)
        return self.graph.targets.framebuffer(*targets)

    def copy_target(self, into: Target, source: Target) -> None:
        """Let an output hold what another target of the picture's size does."""
        self._check(source, self.step is None or source in self.step.readable)
        self.device.gl.copy_framebuffer(self.framebuffer(into), self.graph.targets.framebuffer(source))

    def read(self, target: Target) -> np.ndarray:
        """(H,W,components) float32 of a target of floats, bottom row first, when the GPU is done with it."""
        self._check(target, self.step is None or target in self.step.readable)
        return self.graph.targets.read(target)

    def allocate(self, target: Target, size: tuple[int, int]) -> None:
        """Make sure that an output with a size of its own has this one."""
        self._check(target, self.step is None or target in self.step.outputs)
        self.graph.targets.allocate(target, size)

    def reserve(self, target: Target, size: tuple[int, int]) -> None:
        """The same for this size or a larger one: pages of new memory take long to come."""
        self._check(target, self.step is None or target in self.step.outputs)
        self.graph.targets.reserve(target, size)

    def is_neutral(self, target: Target) -> bool:
        """Whether no pass has made a target, so that neutral texels stand for it."""
        return target not in self.graph.targets.sizes

    @property
    def size(self) -> tuple[int, int]:
        """Of the picture. px"""
        return self.view.width, self.view.height

    @property
    def tiles(self) -> tuple[int, int]:
        """Columns and rows of tiles that cover the picture."""
        return -(-self.view.width // TILE_SIZE), -(-self.view.height // TILE_SIZE)

    @property
    def casts_shadows(self) -> bool:
        """Whether anything can stand in a light's way."""
        return bool(
            self.settings.shadow.enabled
            and self.scene.lights.casts_shadow.any()
            and self.scene.instances.casts_shadow.any()
        )

    @property
    def traces_shadows(self) -> bool:
        """Whether shadow rays are traced that can hit anything."""
        return self.casts_shadows and any(estimator.traces_rays for estimator in self.estimators)

    def shared(self, make: Callable[..., T], *parts: Any) -> T:
        """`make(device, *parts)`: one object for all renderers that use it with the same parts at a time."""
        key = make, *parts
        made: Any = self.device.shared.get(key)
        if made is None:
            made = self.device.shared[key] = make(self.device, *parts)
            self.counts["bytes_uploaded"] += made.bytes
        return made

    def value_of(self, change: Change) -> object:
        """What stands for one part of the input: equal as long as it did not change."""
        view = self.view
        return {
            Change.MESHES: self.scene.meshes,
            Change.INSTANCES: (self.scene.instances, self.anchor.tobytes()),
            Change.MATERIALS: (self.scene.materials, self.scene.images),
            Change.LIGHTS: (self.scene.lights, self.anchor.tobytes()),
            Change.WORLD: self.scene.world,
            Change.VIEW: (
                view.clip_from_view.tobytes(),
                view.view_from_world.tobytes(),
                (view.width, view.height, view.filter_width, view.transparent),
                self.anchor.tobytes(),
            ),
            Change.PIXEL_GRID: (self.sample // len(self.grid.places), len(self.grid.places)),
            Change.SAMPLE: self.sample,
        }[change]


class Pass:
    """One step of the method. Its class and row in the profile have one name; its shaders lie beside its module.

    It is executed when it is due and any of its inputs is new. Feedback is what the sample before has left, which is
    there from the second sample on. An output may depend on some of the inputs alone: its own inputs stand with it.
    """

    schedule: ClassVar[Schedule] = Schedule.EVERY
    inputs: ClassVar[tuple[Input, ...]] = ()
    feedback: ClassVar[tuple[Resource[Any], ...]] = ()
    outputs: ClassVar[Mapping[Resource[Any], tuple[Input, ...]]] = {}
    readable: ClassVar[frozenset[Resource[Any]]] = frozenset()

    def __init_subclass__(cls) -> None:
        resources = (each for each in cls.inputs if isinstance(each, Resource))
        cls.readable = frozenset((*resources, *cls.feedback, *cls.outputs))

    def __init__(self, device: Device):
        self.device = device

    def __repr__(self) -> str:
        return type(self).__name__

    def needed(self, frame: Frame) -> bool:
        """Whether the picture would differ without this pass."""
        return True

    def execute(self, frame: Frame) -> None:
        """Make the outputs; those that are no targets as the last that it does: it may raise Cancelled."""
        raise NotImplementedError

    def tile_program(self, *records: Record, part: str = "", **constants: int | float) -> moderngl.Program:
        """The program of the file named like this pass, or like a part of it, for drawing.draw_tiles."""
        stages = "glsl/tiles.vert", f"{self.name_of(part)}.frag"
        return compile_program(self.device, *stages, records=records, tile_size=TILE_SIZE, **constants)

    def full_screen_program(self, *records: Record, part: str = "", **constants: int | float) -> moderngl.VertexArray:
        """The triangle that covers all pixels, shaded by the file named like this pass, or like a part of it."""
        stages = "glsl/full_screen.vert", f"{self.name_of(part)}.frag"
        program = compile_program(self.device, *stages, records=records, **constants)
        return self.device.gl.vertex_array(program, [])

    def name_of(self, part: str = "") -> str:
        """Of the shader file of this pass, which lies beside it, or of a part of it: its path without a suffix."""
        module = type(self).__module__.rpartition(".gpu.")[2]
        return "_".join(filter(None, (module.replace(".", "/"), part)))


def outputs(*resources: Resource[Any]) -> dict[Resource[Any], tuple[Input, ...]]:
    """Those that depend on all inputs of a pass."""
    return dict.fromkeys(resources, ())
