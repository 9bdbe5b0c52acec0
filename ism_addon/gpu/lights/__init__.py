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

    Its GLSL file has functions whose names begin with its own: `<name>_irradiance(light, p, n)`, unshadowed, for a
    radiance of 1; `<name>_sample(light, p, n, uv)`, a LightSample; `<name>_virtual_weight(light, v, n)`, see area.glsl.
    """

    name: str
    shapes: tuple[int, ...]
    glsl: Path

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
    chosen = {f"has_{each.name}": int(each is light_type) for each in LIGHT_TYPES}
    return (chosen if len(LIGHT_TYPES) > 1 else {}) | light_type.variant(lights, light)


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
    lines = ["struct LightSample { vec3 point; float irradiance; }; // m; an unbiased estimate of light_irradiance"]
    for light_type in LIGHT_TYPES if len(LIGHT_TYPES) > 1 else ():
        has = f"HAS_{light_type.name.upper()}"
        lines += [f"#ifndef {has}", f"#define {has} 1", "#endif"]
    lines += [f'#include "{light_type.glsl.as_posix()}"' for light_type in LIGHT_TYPES]
    lines += [
        switch("float", "irradiance", "vec3 p, vec3 n"),
        switch("LightSample", "sample", "vec3 p, vec3 n, vec2 uv"),
        switch("float", "virtual_weight", "vec3 v, vec3 n"),
    ]
    return "\n".join(lines)


shader_compiler.GENERATED["lights/light.glsl"] = glsl
