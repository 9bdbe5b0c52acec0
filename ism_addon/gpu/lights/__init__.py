# SPDX-License-Identifier: GPL-3.0-or-later
"""Types of light: one interface for culling, shadow rays, shadow maps and shaders.

LIGHT_TYPES lists them. The switch in GLSL, shader variants and the tests of the interface are made from the list. A new
type needs a Python file, a GLSL file and an entry in the list.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from weakref import WeakKeyDictionary

import numpy as np

from ...scene import Lights
from ..environment import map_tables
from ..gl import shader_compiler
from . import modulation
from .area import AreaLight
from .emissive_mesh import EmissiveMesh
from .light_type import LightBounds, LightType
from .point import PointLight
from .spot import SpotLight
from .sun import SunLight
from .world.environment import EnvironmentLight
from .world.even import WorldLight
from .world.map_sun import MapSunLight
from .world.table import ENVIRONMENT, WORLD

#: All light types. A shape belongs to one of them.
LIGHT_TYPES: tuple[LightType, ...] = (
    *(AreaLight(), PointLight(), SpotLight(), SunLight(), EmissiveMesh()),
    *(WorldLight(), EnvironmentLight(), MapSunLight()),
)

#: A point sampled on a light, as seen from a receiver.
LIGHT_SAMPLE = """
struct LightSample {
    vec3 point;     // m
    vec3 wi;        // unit, from the receiver to it
    float radiance; // towards the receiver; 0: no light from this point
    float pdf;      // density by solid angle, 1/sr; 1 if there is only one direction: radiance is irradiance then
    int triangle;   // of an emissive mesh, on which it is; -1 of others
};"""

LIGHT_TABLES = """
#include "textures/scene_records.glsl"
uniform int lights;             // rows of LIGHT
uniform int light_texels;       // of profiles and images
uniform int light_nodes;        // rows of LIGHT_NODE
uniform int light_node_colors;  // rows of LIGHT_NODE_COLOR, if there are any
uniform int emissive_triangles; // rows of EMISSIVE_TRIANGLE
uniform int emissive_colors;    // rows of EMISSIVE_COLOR, if there are any
uniform sampler2D environment_map; // see map_texture.py; and tables of scene_records' texels, see map_tables.py
uniform ivec2 environment_size;
uniform mat3 environment_rotation; // from directions of the world to those of the map
uniform int environment_product;
uniform int environment_fine;
uniform int environment_irradiance_table;
uniform int environment_sun; // see bake_world.py
"""

#: GLSL functions of each light type: result, name, and parameters after the light. The light has radiance 1; p and n
#: are position and normal of a receiver.
GLSL_INTERFACE = (
    ("float", "irradiance", "vec3 p, vec3 n"),  # unshadowed, W/m²
    ("LightSample", "sample", "vec3 p, vec3 n, vec2 uv"),  # uv in [0,1)
    ("float", "pdf", "vec3 p, vec3 n, vec3 wi"),  # of the directions of `sample`; 0 if there is only one
    ("float", "emitted", "vec3 p, vec3 wi"),  # radiance along a ray from p
    ("float", "hit_distance", "vec3 p, vec3 wi"),  # m, along a ray from p on which it emits
    ("vec3", "centre", "vec3 p, vec3 to"),  # about which shadow_softness scales `to`, a point of the light
    ("float", "virtual_weight", "vec3 v, vec3 n, vec3 axis"),  # of a virtual light; v: from it, in the light's space
)

#: Those of shaders for glossy surfaces.
GLOSS_INTERFACE = (
    ("bool", "is_delta", "vec3 p"),  # whether its light comes from one direction only
    ("float", "transformed_irradiance", "vec3 p, mat3 m"),  # of a receiver of normal z, at p = 0, all else times m
    # The radiance, the same in all directions to the light, whose integral that is; 0: of none; or EVERYWHERE.
    ("float", "even_radiance", "vec3 p, vec3 n"),
)


def by_type(lights: Lights) -> Iterator[tuple[LightType, np.ndarray, Lights]]:
    """For each type that has lights: the type, the rows (K,) of its lights, and a table of only these."""
    types = type_indices(LIGHT_TYPES)[lights.shape]
    for index in np.flatnonzero(np.bincount(types)).tolist():
        rows = np.flatnonzero(types == index)
        yield LIGHT_TYPES[index], rows, lights if len(rows) == len(types) else lights.select(rows)


@cache
def type_indices(types: tuple[LightType, ...]) -> np.ndarray:
    """Index in `types` of the type of each shape; -1: of no type."""
    indices = np.full(1 + max(shape for each in types for shape in each.shapes), -1)
    for index, each in enumerate(types):
        indices[list(each.shapes)] = index
    return indices


def is_narrow(lights: Lights) -> np.ndarray:
    """(L,) bool: see LightType.is_narrow."""
    narrow = np.zeros(len(lights.shape), bool)
    for light_type, rows, type_lights in by_type(lights):
        narrow[rows] = light_type.is_narrow(type_lights)
    return narrow | modulation.has_profile(lights) | modulation.has_image(lights)


def bounds_with_falloff(light_type: LightType, lights: Lights, anchor: np.ndarray, working_space: str) -> LightBounds:
    """Bounds of lights of one type for culling, about the anchor (3,) m. Profiles only make lights darker."""
    plain = light_type.bounds(lights, anchor, working_space)
    return modulation.FalloffBounds.of(plain, lights, anchor) if modulation.has_falloff(lights).any() else plain


def type_of(lights: Lights, light: int) -> LightType:
    """The type of a light."""
    return type_of_shape(int(lights.shape[light]), LIGHT_TYPES)


@cache
def type_of_shape(shape: int, types: tuple[LightType, ...]) -> LightType:
    """The type among `types` that a shape belongs to."""
    return next(each for each in types if shape in each.shapes)


@dataclass(frozen=True)
class Variants:
    """Constants of shaders for the lights of a table: `values` (L,C) of the C `names`. Shaders are cached by them."""

    names: tuple[str, ...]
    values: np.ndarray
    #: Results of shader_variant by light, and by whether its irradiance is cached.
    by_light: dict[tuple[int, bool], dict[str, int]] = field(default_factory=dict)

    @classmethod
    def of(cls, lights: Lights) -> "Variants":
        """The variants of a table's lights."""
        columns = {"softness": lights.shadow_softness != 1.0, **modulation.variant(lights)}
        for light_type in LIGHT_TYPES:
            of_type = columns[f"has_{light_type.name}"] = np.isin(lights.shape, light_type.shapes)
            for name, values in light_type.variant(lights).items():
                columns[name] = columns.get(name, 0) | of_type & values
        return cls(tuple(columns), np.stack(list(columns.values()), 1))


#: The variants of tables that exist.
_VARIANTS: WeakKeyDictionary[Lights, Variants] = WeakKeyDictionary()


def variants_of(lights: Lights) -> Variants:
    """The variants of a table; found once."""
    if lights not in _VARIANTS:
        _VARIANTS[lights] = Variants.of(lights)
    return _VARIANTS[lights]


def mixed_variant(lights: Lights, rows: Sequence[int] | None = None) -> dict[str, int]:
    """Constants of a shader for these lights, or for all: some drivers execute branches for others too."""
    variants = variants_of(lights)
    values = variants.values if rows is None else variants.values[list(rows)]
    return dict(zip(variants.names, values.max(0).tolist(), strict=True))


def shader_variant(lights: Lights, light: int, is_cached: bool = False) -> dict[str, int]:
    """Constants of a shader for one light: those of mixed_variant, and how exact its predictions are; found once.

    `is_cached`: whether the shader has the irradiance from the irradiance cache, where it is reliable.
    """
    by_light, light_type = variants_of(lights).by_light, type_of(lights, light)
    if (light, is_cached) not in by_light:
        variant, has_falloff = mixed_variant(lights, [light]), modulation.has_falloff(lights)[light]
        exact_but_for_falloff = is_cached or light_type.is_exact(lights, light)
        # Of a light with a size, the factor of falloff is that of its middle.
        exact = exact_but_for_falloff and (light_type.is_hard(lights, light) or not has_falloff)
        by_light[light, is_cached] = variant | {
            "exact": int(exact),
            "exact_but_for_falloff": int(exact_but_for_falloff),
            "max_rays": light_type.max_rays,
            "lobe_candidates": int(not variant["meshes_with_bvh"]),
        }
    return by_light[light, is_cached]


def switch(result: str, function: str, parameters: str, types: Sequence[LightType]) -> str:
    """GLSL: a function that calls the function of the light's type, one of `types`. The last one needs no test."""
    names = ", ".join(["light", *(parameter.split()[-1] for parameter in parameters.split(", "))])
    prefix = modulation.PLAIN if function in modulation.REPLACED else ""
    lines = [f"{result} {prefix}light_{function}(Light light, {parameters}) {{"]
    for light_type in types:
        is_type = " || ".join(f"light.shape == {shape}" for shape in light_type.shapes)
        test = [] if light_type is types[-1] else [f"    if ({is_type})"]
        lines += [*test, f"        return {light_type.name}_{function}({names});"]
    return "\n".join([*lines, "}"])


def glsl(constants: shader_compiler.Constants) -> str:
    """The generated file lights/light.glsl: the interface of the types that mixed_variant names."""
    types, gloss = [each for each in LIGHT_TYPES if constants.get(f"has_{each.name}", 1)], constants.get("gloss", 0)
    lines = [LIGHT_SAMPLE, LIGHT_TABLES]
    names = modulation.GLSL_CONSTANTS | map_tables.GLSL_CONSTANTS | {"world": WORLD, "environment": ENVIRONMENT}
    lines += [f"#define {name.upper()} {value}" for name, value in names.items()]
    lines += [f"#define HAS_{each.name.upper()} 1" for each in types if f"has_{each.name}" not in constants]
    lines += [f"#define REFLECTED {gloss}"]
    lines += [] if "portals" in constants else ["#define PORTALS 0"]
    if gloss:  # before the types' files, which include it for some of their variants only
        lines += ['#include "closed_forms/transformed_cap.glsl"']
    if "portals" in constants:
        lines += [f'#include "{AreaLight.glsl.as_posix()}"']
    lines += [f'#include "{light_type.glsl.as_posix()}"' for light_type in types]
    if gloss:
        lines += ['#include "lights/transformed_irradiance.glsl"']
    for result, name, parameters in GLSL_INTERFACE + (GLOSS_INTERFACE if gloss else ()):
        lines.append(switch(result, name, parameters, types))
    return "\n".join([*lines, '#include "lights/modulation.glsl"', '#include "lights/light_image.glsl"'])


shader_compiler.GENERATED["lights/light.glsl"] = glsl
