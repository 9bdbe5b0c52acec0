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
from .nodes import color

#: The colour that each closure reflects diffusely, by the closure's name.
DIFFUSE_COLORS = {"diffuse": "color", "translucent": "color", "principled": "base_color"}

#: Limit of a graph's cost: its shader takes Mesa's software driver up to two seconds to compile.
MAX_COST = 800

#: Weight of all closures that are not transparent from which on they are drawn opaque.
MIN_WEIGHT = 1e-3


class Reflection(NamedTuple):
    """What a surface reflects diffusely."""

    base_color: np.ndarray  # (3,), or the mean of what the graph computes
    image: int = -1
    graph: NodeGraph | None = None
    constants: np.ndarray = np.zeros((0, 4), np.float32)


class _Term(NamedTuple):
    """What one closure reflects."""

    weight: Value
    color: Value
    normal: Value


#: The mean of an image's texels by its index: (4,) linear colour and alpha.
MeanTexel = Callable[[int], np.ndarray]


class Surface:
    """The sums of a surface's closures."""

    def __init__(self, reader: GraphReader, closures: Sequence[Closure], mean_texel: MeanTexel):
        self._builder, self._material, self._normal = reader.builder, reader.material, reader.normal()
        self._closures, self._mean_texel = closures, mean_texel

    def reflection(self, findings: Diagnostics) -> Reflection:
        """What the surface reflects, and sentences about what it is not drawn with."""
        terms = self._diffuse_terms(findings)
        for note in self._builder.notes(value for term in terms for value in term):
            findings.warn(note, self._material.name)
        terms = [_Term(*map(self._builder.known, term)) for term in terms]
        mean = sum((self._mean(term.weight) * self._mean(term.color) for term in terms), np.zeros(3))
        mean, plain_normal = np.maximum(mean, 0.0), self._builder.call("geometry_normal")
        if all(term.normal == plain_normal for term in terms):
            if all(term.weight.is_constant and term.color.is_constant for term in terms):
                return Reflection(mean)
            if len(terms) == 1 and terms[0].weight.equals(1.0) and (image := self._plain_image(terms[0].color)) >= 0:
                return Reflection(mean, image)
        closures = [self._builder.call("closure_diffuse", *term) for term in terms]
        graph, constants = self._builder.finish(closures)
        if graph.cost > MAX_COST:
            findings.warn("Materials with too many nodes for one shader are drawn in one colour", self._material.name)
            return Reflection(mean)
        return Reflection(mean, -1, graph, constants)

    def _diffuse_terms(self, findings: Diagnostics) -> list[_Term]:
        """What is reflected, with weights divided by that of what is not transparent."""
        builder, name, opaque = self._builder, self._material.name, constant(1.0)
        terms: list[_Term] = []
        for closure in self._closures:
            if closure.name == UNKNOWN:
                label = closure.node.bl_label
                findings.warn(f"Materials whose surface is a node '{label}' are drawn in their viewport colour", name)
                viewport_color = color(self._material.diffuse_color, MATERIAL_INPUTS["base_color"].default)
                terms.append(_Term(closure.weight, constant(viewport_color), self._normal))
            elif closure.name == "transparent":
                findings.warn("Transparent materials are drawn opaque", name)
                opaque = builder.call("math_subtract", opaque, closure.weight)
            elif closure.name in DIFFUSE_COLORS:
                inputs = closure.inputs
                color_input = inputs[DIFFUSE_COLORS[closure.name]]
                terms.append(_Term(closure.weight, color_input, inputs.get("normal", self._normal)))
        if opaque.equals(1.0):
            return terms
        opaque = builder.call("math_maximum", opaque, constant(MIN_WEIGHT))
        return [each._replace(weight=builder.call("math_divide", each.weight, opaque)) for each in terms]

    def emission(self, findings: Diagnostics) -> np.ndarray:
        """(3,) W/(sr m²): the radiance of the surface, the mean of what varies."""
        name, total = self._material.name, np.zeros(3)
        for closure in self._closures:
            inputs, is_principled = closure.inputs, closure.name == "principled"
            if closure.name not in ("emission", "principled"):
                continue
            prefix = "emission_" if is_principled else ""
            emitted_color, strength = inputs[f"{prefix}color"], inputs[f"{prefix}strength"]
            if emitted_color.equals(0.0) or strength.equals(0.0):
                continue
            roots = closure.weight, emitted_color, strength
            for note in self._builder.notes(roots):
                findings.warn(note, name)
            if any(not self._builder.known(root).is_constant for root in roots):
                findings.warn("Surfaces whose emission nodes give emit about its mean", name)
            emitted = self._mean(strength)
            if is_principled and bpy.app.version >= (5, 0):
                emitted = np.maximum(emitted, 0.0)  # as in Cycles, which subtracted light before
            total += self._mean(closure.weight) * self._mean(emitted_color) * emitted
        if not is_within(total, MAX_EMISSION).all():
            findings.warn("Materials too bright to be drawn emit nothing", name)
            return np.zeros(3, np.float32)
        return total.astype(np.float32)

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
