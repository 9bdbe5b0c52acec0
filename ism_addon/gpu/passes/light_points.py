# SPDX-License-Identifier: GPL-3.0-or-later
"""Virtual point lights inside the area lights: other ones each sample.

Beck-Norén & Valter 2013, section 3.1. The light points of a sample are shared out by power, at least one a
light; a light's radiance and area are exact (see gather), its points only say how much of it is visible.
"""

import numpy as np

from ...color import LUMINANCE
from ...radiometry import light_areas, spread_terms
from ...sampling import additive_sequence, points_on_light, shares
from ...scene import Change, Lights
from ...spaces import orthonormal
from ..layout import LIGHT, LIGHT_POINT
from . import Frame, Pass


def points_per_light(lights: Lights, count: int) -> np.ndarray:
    """(L,) int64: `count` light points by the lights' power; never none, so a few more where lights are many."""
    power = np.abs(lights.radiance @ LUMINANCE) * light_areas(lights)
    return 1 + shares(power if power.sum() > 0.0 else np.ones(len(power)), max(count - len(power), 0))


#: A light point as the maps' drawing needs it: the axes x and z of its map, in anchor space.
MAP = np.dtype([("position", "f4", 3), ("tangent", "f4", 3), ("normal", "f4", 3), ("light", "i4")])


def light_tables(
    lights: Lights, count: int, sample: int, anchor: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows of LIGHT, of LIGHT_POINT and of MAP for one sample."""
    counts = points_per_light(lights, count)
    first = np.cumsum(counts) - counts
    normals = plane_normals(lights)
    tangents, bitangents = orthonormal(normals)
    table = np.zeros(len(counts), LIGHT.dtype)
    table["position"], table["normal"], table["tangent"] = lights.position - anchor, normals, tangents
    for name in ("shape", "axis_u", "axis_v", "casts_shadow", "radiance"):
        table[name] = getattr(lights, name)
    table["first_point"], table["point_count"] = first, counts
    table["spread_tangent"], table["spread_scale"] = spread_terms(lights.spread).T

    owners = np.repeat(np.arange(len(counts)), counts)
    shifts = additive_sequence(sample, 1, 2) + additive_sequence(0, len(counts), 2)
    positions = [points_on_light(lights, light, number, shifts[light]) for light, number in enumerate(counts)]
    offsets = np.concatenate(positions) - lights.position[owners]
    angle = 2.0 * np.pi * additive_sequence(sample * len(owners), len(owners), 1)
    points = np.zeros(len(owners), LIGHT_POINT.dtype)
    points["place"] = np.einsum("nk,ank->na", offsets, np.stack([tangents, bitangents])[:, owners])
    points["turn"] = np.concatenate([np.cos(angle), np.sin(angle)], 1)
    maps = np.zeros(len(owners), MAP)
    maps["position"] = offsets + (lights.position - anchor)[owners]
    maps["tangent"] = np.cos(angle) * tangents[owners] + np.sin(angle) * bitangents[owners]
    maps["normal"], maps["light"] = normals[owners], owners
    return table, points, maps


def plane_normals(lights: Lights) -> np.ndarray:
    """(L,3) unit normals of the planes that the axes span, on the side that shines. A sheared light's may differ."""
    normals = np.cross(lights.axis_u, lights.axis_v)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return np.copysign(1.0, np.einsum("nk,nk->n", normals, lights.normal))[:, None] * normals


class LightPoints(Pass):
    """The tables of lights and of light points."""

    makes = ("lights", "light_points", "maps")
    settings = ("quality.light_points",)
    depends_on = (Change.LIGHTS, Change.SAMPLE)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def draw(self, frame: Frame) -> None:
        lights, points, maps = light_tables(
            frame.scene.lights, frame.settings.quality.light_points, frame.sample, frame.anchor
        )
        frame.tables["lights"] = LIGHT.upload(self.device.gl, lights)
        frame.tables["light_points"] = LIGHT_POINT.upload(self.device.gl, points)
        frame.tables["maps"] = maps
        frame.counts["light_points"] = len(points)
        frame.counts["bytes_uploaded"] += lights.nbytes + points.nbytes
