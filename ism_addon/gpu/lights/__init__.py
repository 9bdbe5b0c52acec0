# SPDX-License-Identifier: GPL-3.0-or-later
"""Types of light: what culling, shadow rays, shadow maps and shaders ask of a light, in one interface.

LIGHT_TYPES lists them. The switch in GLSL, shader variants and the tests of the interface are made from the list, so a
new type is a Python and a GLSL file and a line here.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Protocol

import numpy as np

from ...scene import Lights
from ..culling.surface_bounds import SurfaceBounds
from ..gl import shader_compiler
from .area import AreaLight


class LightBounds(Protocol):
    """K lights of one type by what bounds them."""

    def irradiance(self, surfaces: SurfaceBounds) -> tuple[np.ndarray, np.ndarray]:
        """Luminance (K,N) float32 of the irradiance that nothing hides: never more than the first; about the second."""

    @property
    def peak(self) -> np.ndarray:
        """(K,1) luminance of the irradiance of a light that fills a receiver's hemisphere."""

    def __getitem__(self, some: slice) -> "LightBounds": ...


class LightType(Protocol):
    """Lights of some values of Lights.shape. Tables `lights` have rows of those alone, but where a `row` is asked for.

    Its GLSL file has the functions of GLSL_INTERFACE, whose names there begin with its own name.
    """

    name: str
    shapes: tuple[int, ...]
    glsl: Path
    #: Whether its irradiance in GLSL is exact. Where it is not, shadow rays correct that too; a light that casts no
    #: shadows has no rays.
    exact: bool

    def records(self, lights: Lights, anchor: np.ndarray) -> np.ndarray:
        """Rows (K,) of LIGHT, about the anchor (3,) m."""

    def bounds(self, lights: Lights, anchor: np.ndarray, working_space: str) -> LightBounds:
        """For culling, about the anchor (3,) m."""

    def shadow_ends(self, lights: Lights, anchor: np.ndarray) -> np.ndarray:
        """(2,3,K) m: low and high corners of the boxes in which shadow rays end, about the anchor."""

    def heights(self, lights: Lights, anchor: np.ndarray, boxes: np.ndarray) -> np.ndarray:
        """(N,K) m: how far boxes (2,3,N) reach into what a light can light at all; 0 or less: nothing of them."""

    def is_narrow(self, lights: Lights) -> np.ndarray:
        """(K,) bool: whether it may light what lies between receivers that it does not."""

    def points(self, lights: Lights, row: int, squares: np.ndarray) -> np.ndarray:
        """(N,3) m: from a light's position to points on it, for squares (N,2) in [0,1)."""

    def axes(self, lights: Lights) -> tuple[np.ndarray, np.ndarray]:
        """(K,3) unit each: the axes x and z of the lights' own spaces. Shadow maps look along z."""

    def solid_angles(
        self, lights: Lights, row: int, anchor: np.ndarray, points: np.ndarray, normals: np.ndarray, area: float
    ) -> np.ndarray:
        """(P,) float32, in proportion to the sr that occluders of `area` m² each fill, seen from about a light.

        They lie at points (P,3) about the anchor with normals (P,3). 0 where one can hide nothing of the light.
        """

    def variant(self, lights: Lights, row: int) -> dict[str, int]:
        """Constants of the shader for one light alone: what others would need, some drivers would execute too."""


#: All of them. A shape belongs to one.
LIGHT_TYPES: tuple[LightType, ...] = (AreaLight(),)

#: A point of a light as a receiver sees it.
LIGHT_SAMPLE = """
struct LightSample {
    vec3 point;     // m
    vec3 wi;        // unit, from the receiver to it
    float radiance; // towards the receiver; 0: no light from there
    float pdf;      // density of solid angle, 1/sr; 1 if there is one direction: radiance is irradiance then
};"""

#: Of each light type: result, name and parameters after the light. All are of a light of radiance 1; p and n are the
#: position and the normal of a receiver.
GLSL_INTERFACE = (
    ("float", "irradiance", "vec3 p, vec3 n"),  # of all of the light, W/m²
    ("LightSample", "sample", "vec3 p, vec3 n, vec2 uv"),  # uv in [0,1)
    ("float", "pdf", "vec3 p, vec3 n, vec3 wi"),  # with which `sample` has a direction; 0 where it is the only one
    ("float", "emitted", "vec3 p, vec3 wi"),  # radiance that a ray from p meets
    ("float", "virtual_weight", "vec3 v, vec3 n"),  # of a virtual light, seen from v off it in the light's space
)


def by_type(lights: Lights) -> Iterator[tuple[LightType, np.ndarray, Lights]]:
    """For each type that has any: it, the rows (K,) of its lights, and a table of these alone."""
    for light_type in LIGHT_TYPES:
        rows = np.flatnonzero(np.isin(lights.shape, light_type.shapes))
        if len(rows):
            yield light_type, rows, lights if len(rows) == len(lights.shape) else lights.some(rows)


def is_narrow(lights: Lights) -> np.ndarray:
    """(L,) bool: see LightType.is_narrow."""
    narrow = np.zeros(len(lights.shape), bool)
    for light_type, rows, own in by_type(lights):
        narrow[rows] = light_type.is_narrow(own)
    return narrow


def type_of(lights: Lights, light: int) -> LightType:
    """A light's."""
    return next(each for each in LIGHT_TYPES if lights.shape[light] in each.shapes)


def shader_variant(lights: Lights, light: int) -> dict[str, int]:
    """Constants of a shader for one light alone."""
    light_type = type_of(lights, light)
    chosen = {f"has_{each.name}": int(each is light_type) for each in LIGHT_TYPES} if len(LIGHT_TYPES) > 1 else {}
    return chosen | {"exact": int(light_type.exact)} | light_type.variant(lights, light)


def switch(result: str, function: str, parameters: str) -> str:
    """GLSL: a function of a light that calls the one of its type."""
    names = ", ".join(["light", *(parameter.split()[-1] for parameter in parameters.split(", "))])
    lines = [f"{result} light_{function}(Light light, {parameters}) {{"]
    for light_type in LIGHT_TYPES[:-1]:
        is_own = " || ".join(f"light.shape == {shape}" for shape in light_type.shapes)
        has = f"HAS_{light_type.name.upper()}"
        lines += [f"#if {has}", f"    if ({is_own}) return {light_type.name}_{function}({names});", "#endif"]
    return "\n".join([*lines, f"    return {LIGHT_TYPES[-1].name}_{function}({names});", "}"])


def glsl() -> str:
    """The file lights/light.glsl: the interface of all types."""
    lines = [LIGHT_SAMPLE]
    for light_type in LIGHT_TYPES if len(LIGHT_TYPES) > 1 else ():
        has = f"HAS_{light_type.name.upper()}"
        lines += [f"#ifndef {has}", f"#define {has} 1", "#endif"]
    lines += [f'#include "{light_type.glsl.as_posix()}"' for light_type in LIGHT_TYPES]
    return "\n".join(lines + [switch(*function) for function in GLSL_INTERFACE])


shader_compiler.GENERATED["lights/light.glsl"] = glsl
