# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a world's radiance, as light and as background: constants, or graphs."""

from typing import NamedTuple, Self

import bpy
import numpy as np

from ....color import luminance
from ....scene import NodeGraph, World
from ....scene.limits import MAX_EMISSION, is_within
from ....shading.builder import Builder, Value, constant
from ....shading.node_graph import NUMBERS
from ....shading.operations import OPERATIONS, Constant
from ..diagnostics import Diagnostics
from ..materials import images, nodes
from ..materials.image_reader import ImageReader
from ..materials.transparency import MAX_POINT_COST
from ..node_graphs.reader import UNKNOWN, Ray
from .skies import Disc, Skies, SkySun
from .world_nodes import WORLD_CONVERTERS, WorldGraphReader

NO_CONSTANTS = np.zeros((0, 4), np.float32)


class Radiance(NamedTuple):
    """The radiance (3,) W/(sr m²), or about the mean of what a graph gives."""

    mean: np.ndarray
    graph: NodeGraph | None = None
    constants: np.ndarray = NO_CONSTANTS

    @classmethod
    def even(cls, radiance: np.ndarray) -> Self:
        """The same in all directions; 0 for what is not finite or beyond limits."""
        return cls(np.where(is_within(radiance, MAX_EMISSION), radiance, 0.0).astype(np.float32))


BLACK = Radiance.even(np.zeros(3))


class WorldShader(NamedTuple):
    """What a world emits as light, and what the camera sees."""

    light: Radiance
    background: Radiance
    suns: tuple[SkySun, ...] = ()

    @property
    def graphs(self) -> tuple[NodeGraph, ...]:
        """Those of both."""
        return tuple(each.graph for each in (self.light, self.background) if each.graph is not None)

    def table(self, graphs: tuple[NodeGraph, ...]) -> World:
        """With indices of these graphs."""
        return World.of(
            radiance=self.light.mean,
            background=self.background.mean,
            graph=[-1 if each.graph is None else graphs.index(each.graph) for each in (self.light, self.background)],
            first_constant=[0, len(self.light.constants)],
            constants=np.concatenate([self.light.constants, self.background.constants]),
        )


class WorldReader:
    """Reads worlds. While a slider of one is dragged, its graphs stay the same: new ones take time to compile."""

    def __init__(self, image_reader: ImageReader) -> None:
        self._images, self._used_images = image_reader, frozenset[int]()
        self._images.users.append(lambda: self._used_images)
        #: The session_uid of the latest world, and its graphs.
        self._latest: tuple[int, tuple[NodeGraph, ...]] = (0, ())

    def read(self, world: bpy.types.World | None, findings: Diagnostics) -> WorldShader:
        """The shader of a world; black if there is none."""
        self._used_images = frozenset()
        if world is None:
            return WorldShader(BLACK, BLACK)
        uid, found = world.original.session_uid, Diagnostics()
        shader = self._read(world, found)
        if self._latest[0] == uid and self._latest[1] != shader.graphs:
            found = Diagnostics()
            shader = self._read(world, found, simplify=False)
        findings.merge(found)
        self._latest = uid, shader.graphs
        return shader

    def _read(self, world: bpy.types.World, findings: Diagnostics, simplify: bool = True) -> WorldShader:
        node_tree = nodes.tree(world)
        if node_tree is None:
            color = Radiance.even(nodes.color(world.color, 0.0))
            return with_ray_visibility(world, WorldShader(color, color), findings)
        output, used = nodes.output(node_tree), dict[int, Diagnostics]()
        if output is not None and nodes.source(output.inputs["Volume"]) is not None:
            findings.warn("Volumes of worlds are not drawn", world.name)

        def image(node: bpy.types.ShaderNodeTexImage | bpy.types.ShaderNodeTexEnvironment) -> int:
            if node.image is None:
                findings.warn("Textures of worlds without an image are magenta, as in Blender", world.name)
                return -1
            repeats = getattr(node, "extension", "REPEAT") == "REPEAT"
            index, issues = self._images.index_of(node.image, node.image_user, repeats, on_black=True)
            used[index] = issues
            return index

        reader = WorldGraphReader(WORLD_CONVERTERS, world, {}, image, luminance(images.working_space()), simplify)
        skies = Skies(self._images)
        reader.sky = skies.index_of
        background, to_camera = self._radiance(reader, output, Ray.CAMERA, findings, skies)
        light, to_surfaces = background, to_camera
        if reader.depends_on_ray:
            light, to_surfaces = self._radiance(reader, output, Ray.LIGHT, findings, skies)
        if light.graph is None and (light.mean < 0.0).any():
            findings.warn("Worlds of negative radiance light nothing", world.name)
            light = Radiance.even(np.maximum(light.mean, 0.0))
        suns = tuple(
            SkySun(skies.discs[index].sun, irradiance, bool(to_camera[index].any()))
            for index, irradiance in to_surfaces.items()
        )
        if skies.is_moved:
            findings.warn("The suns of Sky Textures are not moved by nodes that move the sky", world.name)
        for issues in used.values():
            findings.merge(issues)
        self._used_images = frozenset(used) | skies.indices
        return with_ray_visibility(world, WorldShader(light, background, suns), findings)

    def _radiance(
        self,
        reader: WorldGraphReader,
        output: bpy.types.Node | None,
        ray: Ray,
        findings: Diagnostics,
        skies: Skies,
    ) -> tuple[Radiance, dict[int, np.ndarray]]:
        """What rays of a type find, and the irradiance (3,) that the nodes leave of the suns of skies, by image."""
        builder, name, total = reader.builder, reader.material.name, constant((0.0, 0.0, 0.0))
        for closure in reader.surface(output, ray):
            if closure.name == "emission":
                scale = builder.call("math_multiply", closure.weight, closure.inputs["strength"])
                total = builder.call("vector_add", total, builder.call("vector_scale", closure.inputs["color"], scale))
            elif closure.name == UNKNOWN:
                findings.warn(f"Worlds are drawn without their node '{closure.node.bl_label}'", name)
        for note in builder.notes([total]):
            findings.warn(note, name)
        about = np.asarray(builder.estimate(total, self._unknown))
        suns = {index: self._brighter(builder, total, index, disc) - about for index, disc in skies.discs.items()}
        mean = Radiance.even(about)
        if not builder.varies(total):
            return mean, suns
        graph, constants = builder.finish([builder.call("closure_emission", total)])
        if graph.cost > MAX_POINT_COST:
            findings.warn("Worlds with too many nodes are drawn in one color", name)
            return mean, suns
        return Radiance(mean.mean, graph, constants), suns

    def _brighter(self, builder: Builder, total: Value, sky: int, disc: Disc) -> np.ndarray:
        """About the mean if that of a sky was larger by the irradiance of its sun: nodes mostly scale and mix."""

        def unknown(name: str, operands: tuple[Constant, ...]) -> Constant:
            about = self._unknown(name, operands)
            is_sky = name.startswith("image") and int(operands[0]) == sky
            return about + np.append(disc.irradiance, 0.0) if is_sky else about

        return np.asarray(builder.estimate(total, unknown))

    def _unknown(self, name: str, operands: tuple[Constant, ...]) -> Constant:
        """About the mean of an operation that is not evaluated here."""
        if name.startswith("image"):
            return self._images.mean_texel(int(operands[0]))
        return np.full(NUMBERS.get(OPERATIONS[name].result, 1), OPERATIONS[name].mean)


def with_ray_visibility(world: bpy.types.World, shader: WorldShader, findings: Diagnostics) -> WorldShader:
    """The shader without what the world's ray visibility hides."""
    visibility = getattr(world, "cycles_visibility", None)  # Cycles can be switched off
    if visibility is None:
        return shader
    if visibility.diffuse != visibility.glossy:
        findings.warn("Worlds light diffuse and glossy surfaces alike", world.name)
    light = shader.light if visibility.diffuse else BLACK
    background = shader.background if visibility.camera else BLACK
    suns = [each._replace(visible=each.visible and visibility.camera) for each in shader.suns if visibility.diffuse]
    return WorldShader(light, background, tuple(suns))
