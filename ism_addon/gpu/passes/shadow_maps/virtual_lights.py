# SPDX-License-Identifier: GPL-3.0-or-later
"""Virtual point lights inside the area lights: other ones each sample.

Beck-Norén & Valter 2013, section 3.1. The light points of a sample are shared out by what they change (see shares); a
light's radiance and area are exact (see gather), its points only say how much of it is visible.
"""

import numpy as np

from ....resources import (
    CONTRIBUTING_LIGHTS,
    LIGHT_IMPORTANCE,
    SHADOW_MAP_VIEWS,
    VIRTUAL_LIGHT_COUNTS,
    VIRTUAL_LIGHT_RANGES,
    VIRTUAL_LIGHTS,
)
from ....sampling.dimensions import Dimension, draw
from ....sampling.points import lattice, proportional_counts
from ....scene import Change, Lights
from ...frame import Frame, Pass, outputs
from ...gl.shader_records import VIRTUAL_LIGHT, VIRTUAL_LIGHT_RANGE
from ...lights import by_type, type_of

#: A light point as the maps' drawing needs it: the axes x and z of its map, in anchor space.
SHADOW_MAP_VIEW = np.dtype([("position", "f4", 3), ("tangent", "f4", 3), ("normal", "f4", 3), ("light", "i4")])


def allocate_virtual_lights(wanting: list[int], weights: np.ndarray, count: int) -> dict[int, int]:
    """`count` light points for those that want any of L lights, by weights (L,); one at least for each."""
    known = weights[wanting] if weights[wanting].any() else np.ones(len(wanting))
    more = proportional_counts(known, max(count - len(wanting), 0))
    return {light: 1 + int(number) for light, number in zip(wanting, more, strict=True)}


def virtual_light_tables(
    lights: Lights, points_per_light: dict[int, int], sample: int, anchor: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows of VIRTUAL_LIGHT_RANGE, of VIRTUAL_LIGHT and of SHADOW_MAP_VIEW for one sample."""
    counts = np.array(list(points_per_light.values()), int)
    of_lights = np.zeros(len(counts), VIRTUAL_LIGHT_RANGE.dtype)
    of_lights["light"], of_lights["count"] = list(points_per_light), counts
    of_lights["first"] = np.cumsum(counts) - counts

    owners = np.repeat(list(points_per_light), counts).astype(int)
    tangents, normals = np.zeros((2, len(lights.shape), 3))
    for light_type, rows, own in by_type(lights):
        tangents[rows], normals[rows] = light_type.axes(own)
    bitangents = np.cross(normals, tangents)
    shifts = draw(Dimension.VIRTUAL_LIGHT, light=np.arange(len(normals)), sample=sample)
    squares = {light: lattice(count, shifts[light]) for light, count in points_per_light.items()}
    offsets = np.concatenate(
        [np.zeros((0, 3)), *(type_of(lights, light).points(lights, light, squares[light]) for light in squares)]
    )
    angle = 2.0 * np.pi * draw(Dimension.MAP_ROTATION, map=sample * len(owners) + np.arange(len(owners)))
    points = np.zeros(len(owners), VIRTUAL_LIGHT.dtype)
    points["offset"] = np.einsum("nk,ank->na", offsets, np.stack([tangents, bitangents, normals])[:, owners])
    points["rotation"] = np.concatenate([np.cos(angle), np.sin(angle)], 1)
    maps = np.zeros(len(owners), SHADOW_MAP_VIEW)
    maps["position"] = offsets + (lights.position - anchor)[owners]
    maps["tangent"] = np.cos(angle) * tangents[owners] + np.sin(angle) * bitangents[owners]
    maps["normal"], maps["light"] = normals[owners], owners
    return of_lights, points, maps


class PlaceVirtualLights(Pass):
    """The tables of light points, and of which are whose."""

    inputs = LIGHT_IMPORTANCE, CONTRIBUTING_LIGHTS, Change.LIGHTS, Change.SAMPLE, "quality.virtual_lights"
    outputs = outputs(VIRTUAL_LIGHT_COUNTS, VIRTUAL_LIGHT_RANGES, VIRTUAL_LIGHTS, SHADOW_MAP_VIEWS)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        lights, counts = frame.scene.lights, dict.fromkeys(frame[CONTRIBUTING_LIGHTS], 0)
        wanting = [light for light in counts if frame.casts_shadows and lights.casts_shadow[light]]
        if wanting:
            counts |= allocate_virtual_lights(wanting, frame[LIGHT_IMPORTANCE], frame.settings.quality.virtual_lights)
        of_lights, points, maps = virtual_light_tables(lights, counts, frame.sample, frame.anchor)
        frame[VIRTUAL_LIGHT_COUNTS] = counts
        frame[VIRTUAL_LIGHT_RANGES] = VIRTUAL_LIGHT_RANGE.upload(self.device, of_lights)
        frame[VIRTUAL_LIGHTS] = VIRTUAL_LIGHT.upload(self.device, points)
        frame[SHADOW_MAP_VIEWS] = maps
        frame.counts["virtual_lights"] = len(points)
        frame.counts["bytes_uploaded"] += of_lights.nbytes + points.nbytes
