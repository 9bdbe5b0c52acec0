# SPDX-License-Identifier: GPL-3.0-or-later
"""The closures of a material's surface: what they reflect, as a constant, an image or a graph, and what they emit."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import bpy
import numpy as np

from ....scene import MATERIAL_INPUTS, NodeGraph
from ....scene.limits import MAX_EMISSION, is_within
from ....shading.builder import Value, constant
from ....shading.inputs import EXTENSIONS
from ....shading.node_graph import NUMBERS
from ....shading.operations import OPERATIONS, Constant
from ..diagnostics import Diagnostics
from ..node_graphs.reader import UNKNOWN, Closure, GraphReader
from .lobes import BLACK, ONE, ZERO, Lobe, Lobes
from .nodes import color
from .transparency import ADDED_PASS_LIMIT, MAX_POINT_COST, OPEN, Transparency, covered, passing, transparency

#: Limit of a graph's cost: its shader takes Mesa's software driver up to two seconds to compile.
MAX_COST = 800

#: The least probability that a surface is drawn by which weights of its closures are divided.
MIN_WEIGHT = constant(1e-3)


class Reflection(NamedTuple):
    """What a surface reflects."""

    base_color: np.ndarray  # (3,), or the mean of what the graph computes
    image: int = -1
    graph: NodeGraph | None = None
    constants: np.ndarray = np.zeros((0, 4), np.float32)


class Emission(NamedTuple):
    """What a surface emits: its radiance (3,) W/(sr m²), about the mean of one that varies; then a graph too."""

    radiance: np.ndarray
    graph: NodeGraph | None = None
    constants: np.ndarray = np.zeros((0, 4), np.float32)


#: The mean of an image's texels by its index: (4,) linear colour and alpha.
MeanTexel = Callable[[int], np.ndarray]


class Surface:
    """The sums of a surface's closures."""

    def __init__(self, reader: GraphReader, closures: Sequence[Closure], mean_texel: MeanTexel):
        self._builder, self._material, self._normal = reader.builder, reader.material, reader.normal()
        self._closures, self._mean_texel = closures, mean_texel
        self._pass_limit = ADDED_PASS_LIMIT if self._adds_to_more_than_one() else None

    def reflection(self, findings: Diagnostics) -> Reflection:
        """What the surface reflects, and sentences about what it is not drawn with."""
        lobes = self._lobes(findings)
        for note in self._builder.notes(lobe.operation for lobe in lobes):
            findings.warn(note, self._material.name)
        mean = np.maximum(sum((self._mean(each.weight) * self._mean(each.color) for each in lobes), np.zeros(3)), 0.0)
        if all(map(self._is_plain, lobes)):
            if all(each.weight.is_constant and each.color.is_constant for each in lobes):
                return Reflection(mean)
            if len(lobes) == 1 and lobes[0].weight.equals(1.0) and (image := self._plain_image(lobes[0].color)) >= 0:
                return Reflection(mean, image)
        graph, constants = self._builder.finish([each.operation for each in lobes])
        if graph.cost > MAX_COST:
            findings.warn("Materials with too many nodes for one shader are drawn in one colour", self._material.name)
            return Reflection(mean)
        return Reflection(mean, -1, graph, constants)

    def _is_plain(self, lobe: Lobe) -> bool:
        """Whether a lobe is diffuse, with the mesh's own normals."""
        name, (*_, normal), _ = self._builder.operation_of(lobe.operation)
        return name == "closure_diffuse" and normal == self._builder.call("geometry_normal")

    def _lobes(self, findings: Diagnostics) -> list[Lobe]:
        """What is reflected where camera rays do not pass: with weights divided by the probability of that."""
        builder, name = self._builder, self._material.name
        shaders = [each for each in self._closures if each.name != "transparent"]
        opaque = self._opaque()
        is_alone = len(self._closures) == 1 and shaders == self._closures and shaders[0].weight.equals(1.0)
        maker, lobes = Lobes(builder, self._normal, corrects_bumps(self._material)), list[Lobe]()
        for closure in shaders:
            weight = closure.weight
            if not opaque.equals(1.0) and not is_alone:
                weight = builder.call("math_multiply", weight, covered(builder, closure))
                weight = builder.call("math_divide", weight, builder.call("math_maximum", opaque, MIN_WEIGHT))
            scale = builder.call("grey", weight)
            if closure.name == UNKNOWN:
                label = closure.node.bl_label
                findings.warn(f"Materials whose surface is a node '{label}' are drawn in their viewport colour", name)
                viewport_color = color(self._material.diffuse_color, MATERIAL_INPUTS["base_color"].default)
                lobes += maker.diffuse(scale, constant(viewport_color), self._normal)
            else:
                lobes += maker.of(closure, scale)
        return lobes

    def transparency(self, closures: Sequence[Closure], findings: Diagnostics) -> Transparency | None:
        """What passes through a surface of these closures; None if nothing does."""
        return transparency(self._builder, closures, self._mean, self._pass_limit, self._material, findings)

    def emission(self, findings: Diagnostics) -> Emission:
        """The radiance of the surface."""
        builder, name, total, mean = self._builder, self._material.name, BLACK, np.zeros(3)
        for closure in self._closures:
            inputs, is_principled = closure.inputs, closure.name == "principled"
            if closure.name not in ("emission", "principled"):
                continue
            prefix = "emission_" if is_principled else ""
            color, strength = inputs[f"{prefix}color"], inputs[f"{prefix}strength"]
            if color.equals(0.0) or strength.equals(0.0):
                continue
            if is_principled and bpy.app.version >= (5, 0):
                strength = builder.call("math_maximum", strength, ZERO)  # as in Cycles, which subtracted light before
            weight = builder.call("math_multiply", closure.weight, covered(builder, closure))
            scale = builder.call("math_multiply", weight, strength)
            total = builder.call("vector_add", total, builder.call("vector_scale", color, scale))
            mean += self._mean(scale) * self._mean(color)
        for note in builder.notes([total]):
            findings.warn(note, name)
        if not is_within(mean, MAX_EMISSION).all():
            findings.warn("Materials too bright to be drawn emit nothing", name)
            return Emission(np.zeros(3, np.float32))
        radiance = mean.astype(np.float32)
        if total.equals(0.0):
            return Emission(radiance)
        opaque = self._opaque()
        if opaque.equals(1.0) and not builder.varies(total):
            return Emission(radiance)
        # What the camera sees is divided by the probability that it sees the surface.
        closures = [builder.call("closure_emission", total)]
        if not opaque.equals(1.0):
            closures.append(builder.call("closure_transparent", passing(builder, self._closures)))
        if self._pass_limit is not None:
            closures.append(builder.call("closure_pass_limit", self._pass_limit))
        graph, constants = builder.finish(closures)
        if graph.uses("ambient_occlusion"):
            findings.warn(OPEN, name)
        if graph.cost > MAX_POINT_COST:
            findings.warn("Materials with too many nodes for what they emit emit evenly", name)
            return Emission(radiance)
        return Emission(radiance, graph, constants)

    def _opaque(self) -> Value:
        """The probability that camera rays do not pass the surface: see surfaces/instance_fragment.glsl."""
        passes = self._builder.call("largest", passing(self._builder, self._closures))
        if self._pass_limit is not None:
            passes = self._builder.call("math_minimum", passes, self._pass_limit)
        return self._builder.call("math_subtract", ONE, passes)

    def _adds_to_more_than_one(self) -> bool:
        """Whether shaders are added to a transparent one instead of mixed with it, or its color is above 1."""
        transparent = [each for each in self._closures if each.name == "transparent"]
        brightest = max((float(np.max(self._mean(each.inputs["color"]))) for each in transparent), default=0.0)
        weights = sum(float(np.mean(self._mean(each.weight))) for each in self._closures)
        return bool(transparent) and weights * max(brightest, 1.0) > 1.001 and len(transparent) < len(self._closures)

    def _mean(self, value: Value) -> Constant:
        """About the mean of a value over the surface: with the means of images."""

        def unknown(name: str, operands: tuple[Constant, ...]) -> Constant:
            if name.startswith("image"):
                return self._mean_texel(int(operands[0]))
            return np.full(NUMBERS.get(OPERATIONS[name].result, 1), OPERATIONS[name].mean)

        return self._builder.estimate(value, unknown)

    def _plain_image(self, reflected: Value) -> int:
        """The index of the image that a colour is, linearly interpolated at the mesh's own coordinates; or -1."""
        name, operands, _ = self._builder.operation_of(reflected)
        if name != "color_of":
            return -1
        name, operands, extension = self._builder.operation_of(operands[0])
        if name != "image_linear" or EXTENSIONS[extension] not in ("REPEAT", "EXTEND"):
            return -1
        image, vector = operands
        if vector.is_constant:
            return -1
        return int(image.constant) if self._builder.operation_of(vector)[0] == "uv_map" else -1


def corrects_bumps(material: bpy.types.Material) -> bool:
    """Cycles' setting of a material, which is on where Cycles is not installed."""
    return getattr(getattr(material, "cycles", None), "use_bump_map_correction", True)
