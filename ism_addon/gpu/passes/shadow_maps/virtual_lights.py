# SPDX-License-Identifier: GPL-3.0-or-later
"""Virtual point lights on the lights, other ones for each sample.

Beck-Norén & Valter 2013, section 3.1. The virtual lights of a sample are allocated by importance (see
light_importance). A light's unshadowed radiance has a closed form (see gather); its virtual lights only estimate its
visibility.
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

#: What a shadow map is drawn from: its virtual light's position in anchor space, and a rotation to map space.
SHADOW_MAP_VIEW = np.dtype([("position", "f4", 3), ("map_from_anchor", "f4", (3, 3)), ("light", "i4")])


def allocate_virtual_lights(lights: list[int], importance: np.ndarray, count: int) -> dict[int, int]:
    """How many of `count` virtual lights each of these lights gets, by importance (L,) of all lights; at least one."""
    weights = importance[lights] if importance[lights].any() else np.ones(len(lights))
    additional = proportional_counts(weights, max(count - len(lights), 0))
    return {light: 1 + int(number) for light, number in zip(lights, additional, strict=True)}


def virtual_light_tables(
    lights: Lights, counts_of_lights: dict[int, int], sample: int, anchor: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows of VIRTUAL_LIGHT_RANGE, of VIRTUAL_LIGHT and of SHADOW_MAP_VIEW for one sample."""
    counts = np.array(list(counts_of_lights.values()), int)
    ranges = np.zeros(len(counts), VIRTUAL_LIGHT_RANGE.dtype)
    ranges["light"], ranges["count"] = list(counts_of_lights), counts
    ranges["first"] = np.cumsum(counts) - counts

    light_of = np.repeat(list(counts_of_lights), counts).astype(int)
    tangents, normals = np.zeros((2, len(lights.shape), 3))
    for light_type, rows, type_lights in by_type(lights):
        tangents[rows], normals[rows] = light_type.axes(type_lights)
    axes = np.stack([tangents, np.cross(normals, tangents), normals])
    shifts = draw(Dimension.VIRTUAL_LIGHT, light=np.arange(len(normals)), sample=sample)
    squares = {light: lattice(count, shifts[light]) for light, count in counts_of_lights.items()}
    offsets = np.concatenate(
        [np.zeros((0, 3)), *(type_of(lights, light).points(lights, light, squares[light]) for light in squares)]
    )
    angle = 2.0 * np.pi * draw(Dimension.MAP_ROTATION, map=sample * len(light_of) + np.arange(len(light_of)))
    virtual_lights = np.zeros(len(light_of), VIRTUAL_LIGHT.dtype)
    virtual_lights["offset"] = np.einsum("nk,ank->na", offsets, axes[:, light_of])
    virtual_lights["rotation"] = np.concatenate([np.cos(angle), np.sin(angle)], 1)
    views = np.zeros(len(light_of), SHADOW_MAP_VIEW)
    views["position"] = offsets + (lights.position - anchor)[light_of]
    x, y, z = axes[:, light_of]
    views["map_from_anchor"][:, 0] = np.cos(angle) * x + np.sin(angle) * y
    views["map_from_anchor"][:, 1] = np.cos(angle) * y - np.sin(angle) * x
    views["map_from_anchor"][:, 2] = z
    views["light"] = light_of
    return ranges, virtual_lights, views


class PlaceVirtualLights(Pass):
    """Place virtual lights on the lights: their table, and the range of each light in it."""

    inputs = LIGHT_IMPORTANCE, CONTRIBUTING_LIGHTS, Change.LIGHTS, Change.SAMPLE, "quality.virtual_lights"
    outputs = outputs(VIRTUAL_LIGHT_COUNTS, VIRTUAL_LIGHT_RANGES, VIRTUAL_LIGHTS, SHADOW_MAP_VIEWS)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        lights, counts = frame.scene.lights, dict.fromkeys(frame[CONTRIBUTING_LIGHTS], 0)
        casters = [light for light in counts if frame.casts_shadows and lights.casts_shadow[light]]
        if casters:
            counts |= allocate_virtual_lights(casters, frame[LIGHT_IMPORTANCE], frame.settings.quality.virtual_lights)
        ranges, virtual_lights, views = virtual_light_tables(lights, counts, frame.sample, frame.anchor)
        frame[VIRTUAL_LIGHT_COUNTS] = counts
        frame[VIRTUAL_LIGHT_RANGES] = VIRTUAL_LIGHT_RANGE.upload(self.device, ranges)
        frame[VIRTUAL_LIGHTS] = VIRTUAL_LIGHT.upload(self.device, virtual_lights)
        frame[SHADOW_MAP_VIEWS] = views
        frame.counts["virtual_lights"] = len(virtual_lights)
        frame.counts["bytes_uploaded"] += ranges.nbytes + virtual_lights.nbytes
