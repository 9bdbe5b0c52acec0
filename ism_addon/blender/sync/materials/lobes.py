# SPDX-License-Identifier: GPL-3.0-or-later
"""The lobes that closures consist of, as operations of a graph."""

from collections.abc import Iterator
from typing import NamedTuple

import bpy

from ....shading.builder import Builder, Value, constant
from ....shading.closures import BUMPS
from ..node_graphs.reader import Closure

BLACK = constant((0.0, 0.0, 0.0))
ONE, ZERO = constant(1.0), constant(0.0)

#: The distribution of microfacets between which light is reflected more than once.
MULTIPLE = "MULTI_GGX"
#: The distribution that falls off more steeply than GGX.
BECKMANN = "BECKMANN"

#: Whether a coat's microfacets, and the facets of rough diffuse surfaces, are of that kind in this release of Cycles.
MULTIPLE_IN_COATS = int(bpy.app.version >= (4, 4))
MULTIPLE_IN_DIFFUSE = int(bpy.app.version >= (4, 3))

#: By which function this release of Cycles shadows bumps, see materials/bump_shadowing.glsl.
BUMP_SHADOWING = 2 if bpy.app.version >= (4, 5) else 1

#: Alpha of microfacets below which they are those of a mirror.
MIN_ALPHA = constant(1e-6)


class Lobe(NamedTuple):
    """One lobe of a surface: an operation that adds it to the closures, and about its color."""

    operation: Value
    weight: Value
    color: Value


class Lobes:
    """Makes the lobes of closures, with one builder."""

    def __init__(self, builder: Builder, normal: Value, corrects_bumps: bool = True):
        """`normal`: of shaders without another one. `corrects_bumps`: see corrects_bumps in surface.py."""
        self._builder, self._normal, self._corrects_bumps = builder, normal, corrects_bumps

    def of(self, closure: Closure, weight: Value) -> Iterator[Lobe]:
        """The lobes of a closure of this weight, a color; none of one that is not known, or only emits."""
        makers = {
            "diffuse": self._diffuse,
            "translucent": self._diffuse,
            "subsurface": self._diffuse,
            "glossy": self._glossy,
            "metallic": self._metallic,
            "glass": self._glass,
            "sheen": self._sheen,
            "principled": self._principled,
        }
        if closure.name in makers:
            yield from makers[closure.name](closure, weight)
            if self._is_bumped(self._normal_of(closure)):
                shadowing = self._builder.call(BUMPS, self._normal_of(closure), parameter=BUMP_SHADOWING)
                yield Lobe(shadowing, ONE, BLACK)
            if getattr(closure.node, "distribution", MULTIPLE) == BECKMANN:
                yield Lobe(self._builder.call("closure_beckmann", self._glossy_normal_of(closure)), ONE, BLACK)

    def diffuse(self, weight: Value, color: Value, normal: Value, roughness: Value = ZERO) -> Iterator[Lobe]:
        """A diffuse lobe."""
        if self._is_nothing(weight) or self._is_nothing(color):
            return
        if roughness.equals(0.0):
            reflectance = self._builder.call("vector_multiply", weight, color)
            operation = self._builder.call("closure_diffuse", reflectance, normal)
        else:
            operands = weight, color, roughness, normal
            operation = self._builder.call("closure_rough_diffuse", *operands, parameter=MULTIPLE_IN_DIFFUSE)
        yield Lobe(operation, weight, color)

    def _diffuse(self, closure: Closure, weight: Value) -> Iterator[Lobe]:
        roughness = closure.inputs.get("roughness", ZERO)
        yield from self.diffuse(weight, closure.inputs["color"], self._normal_of(closure), roughness)

    def _glossy(self, closure: Closure, weight: Value) -> Iterator[Lobe]:
        call, inputs = self._builder.call, closure.inputs
        roughness = inputs["roughness"]
        if "tangent" in inputs:
            anisotropy = call("clamp_minmax", inputs["anisotropy"], constant(-0.99), constant(0.99))
            narrowed = call("math_subtract", ONE, call("math_absolute", anisotropy))
            is_across = call("math_greater_than", anisotropy, ZERO)
            aspect = call("mix_float", is_across, narrowed, call("math_divide", ONE, narrowed))
            roughness, aspect = self._shape(roughness, aspect)
            yield self._anisotropy(closure, aspect)
        operands = weight, inputs["color"], roughness, self._glossy_normal_of(closure)
        yield self._lobe("closure_glossy", closure, operands, weight, inputs["color"])

    def _metallic(self, closure: Closure, weight: Value) -> Iterator[Lobe]:
        inputs = closure.inputs
        roughness, lobes = self._anisotropic_roughness(closure)
        yield from lobes
        yield self._metal(closure, weight, inputs["base_color"], inputs["edge_tint"], roughness)

    def _metal(self, closure: Closure, weight: Value, color: Value, edge_tint: Value, roughness: Value) -> Lobe:
        operands = weight, color, edge_tint, roughness, self._glossy_normal_of(closure)
        return self._lobe("closure_metal", closure, operands, weight, color)

    def _glass(self, closure: Closure, weight: Value) -> Iterator[Lobe]:
        inputs = closure.inputs
        operands = weight, inputs["color"], inputs["ior"], inputs["roughness"], self._glossy_normal_of(closure)
        yield self._lobe("closure_glass", closure, operands, weight, BLACK)

    def _sheen(self, closure: Closure, weight: Value) -> Iterator[Lobe]:
        color = self._builder.call("vector_multiply", weight, closure.inputs["color"])
        operation = self._builder.call("closure_sheen", color, closure.inputs["roughness"], self._normal_of(closure))
        yield Lobe(operation, weight, closure.inputs["color"])

    def _anisotropic_roughness(self, closure: Closure) -> tuple[Value, list[Lobe]]:
        """The roughness of Principled or Metallic BSDF's microfacets, and what makes their lobes anisotropic."""
        call, inputs = self._builder.call, closure.inputs
        if "tangent" not in inputs:
            return inputs["roughness"], []
        rest = call("math_subtract", ONE, call("math_multiply", constant(0.9), call("saturate", inputs["anisotropy"])))
        roughness, aspect = self._shape(inputs["roughness"], call("math_sqrt", rest))
        return roughness, [self._anisotropy(closure, aspect)]

    def _shape(self, roughness: Value, aspect: Value) -> tuple[Value, Value]:
        """Roughness and aspect of microfacets after alpha, roughness² over and times the aspect, is limited to 1."""
        call, limited = self._builder.call, self._builder.call("saturate", roughness)
        alpha = call("math_maximum", call("math_multiply", limited, limited), MIN_ALPHA)
        along = call("saturate", call("math_divide", alpha, aspect))
        across = call("saturate", call("math_multiply", alpha, aspect))
        mean = call("math_sqrt", call("math_multiply", along, across))
        return call("math_sqrt", mean), call("math_sqrt", call("math_divide", across, along))

    def _anisotropy(self, closure: Closure, aspect: Value) -> Lobe:
        """What makes the glossy lobes anisotropic."""
        operands = aspect, closure.inputs["rotation"], closure.inputs["tangent"], self._glossy_normal_of(closure)
        return Lobe(self._builder.call("closure_anisotropy", *operands), ONE, BLACK)

    def _principled(self, closure: Closure, weight: Value) -> Iterator[Lobe]:
        """Sheen, a coat, metal beside a dielectric, and a diffuse lobe: each has what those above do not reflect."""
        builder, inputs = self._builder, closure.inputs
        normal, base_color, tint = self._normal_of(closure), inputs["base_color"], inputs["specular_tint"]
        coat_normal = self._corrected(inputs["coat_normal"])
        roughness, anisotropy = self._anisotropic_roughness(closure)
        if not self._is_nothing(inputs["sheen"]):
            amount = builder.call("vector_scale", inputs["sheen_tint"], inputs["sheen"])
            sheen = builder.call("vector_multiply", weight, amount)
            yield Lobe(builder.call("closure_sheen", sheen, inputs["sheen_roughness"], normal), weight, BLACK)
            weight = builder.call("below_sheen", weight, amount, inputs["sheen_roughness"], normal)
        if not self._is_nothing(inputs["coat"]):
            coat = builder.call("vector_scale", weight, inputs["coat"])
            operands = coat, inputs["coat_ior"], inputs["coat_roughness"], coat_normal
            yield Lobe(builder.call("closure_coat", *operands, parameter=MULTIPLE_IN_COATS), weight, BLACK)
            shape = inputs["coat_ior"], inputs["coat_roughness"], inputs["coat_tint"], coat_normal
            weight = builder.call("below_coat", weight, inputs["coat"], *shape, parameter=MULTIPLE_IN_COATS)
        metallic = builder.call("saturate", inputs["metallic"])
        if not self._is_nothing(metallic):
            metal = builder.call("vector_scale", weight, metallic)
            yield self._metal(closure, metal, base_color, tint, roughness)
            weight = builder.call("vector_scale", weight, builder.call("math_subtract", ONE, metallic))
        yield from anisotropy
        if self._is_nothing(weight):
            return
        level = inputs["specular_ior_level"]
        if not self._is_nothing(level) and not (builder.simplifies and inputs["ior"].equals(1.0)):
            dielectric = weight, inputs["ior"], level, tint, roughness, self._glossy_normal_of(closure)
            yield self._lobe("closure_dielectric", closure, dielectric, weight, BLACK)
            weight = builder.call("below_dielectric", *dielectric, parameter=multiple(closure))
        transmission = builder.call("saturate", inputs["transmission"])
        weight = builder.call("vector_scale", weight, builder.call("math_subtract", ONE, transmission))
        yield from self.diffuse(weight, base_color, normal, inputs.get("diffuse_roughness", ZERO))

    def _normal_of(self, closure: Closure) -> Value:
        return closure.inputs.get("normal", self._normal)

    def _glossy_normal_of(self, closure: Closure) -> Value:
        return self._corrected(self._normal_of(closure))

    def _corrected(self, normal: Value) -> Value:
        """The normal of a glossy lobe: with bumps, one that reflects what is above the surface."""
        return self._builder.call("reflecting_normal", normal) if self._is_bumped(normal) else normal

    def _is_bumped(self, normal: Value) -> bool:
        """Whether Cycles corrects what bumps have made of the normal."""
        return self._corrects_bumps and normal != self._normal

    def _lobe(self, operation: str, closure: Closure, operands: tuple[Value, ...], weight: Value, color: Value) -> Lobe:
        return Lobe(self._builder.call(operation, *operands, parameter=multiple(closure)), weight, color)

    def _is_nothing(self, value: Value) -> bool:
        """Whether a lobe of this weight can be left out."""
        return self._builder.simplifies and value.equals(0.0)


def multiple(closure: Closure) -> int:
    """1 if light is reflected between microfacets more than once, or 0: the parameter of glossy lobes."""
    return int(getattr(closure.node, "distribution", MULTIPLE) == MULTIPLE)
