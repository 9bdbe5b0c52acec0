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
    RECEIVER_REGION,
    SHADOW_MAP_VIEWS,
    VIRTUAL_LIGHT_COUNTS,
    VIRTUAL_LIGHT_RANGES,
    VIRTUAL_LIGHTS,
)
from ....resources.world import BAKED_WORLD
from ....sampling.dimensions import Dimension, draw
from ....sampling.points import lattice, proportional_counts
from ....scene import Change, Lights
from ....spaces import orthonormal
from ...culling.receiver_region import ReceiverRegion
from ...frame import Frame, Pass, outputs
from ...gl.shader_records import VIRTUAL_LIGHT, VIRTUAL_LIGHT_RANGE
from ...lights import by_type, type_of
from ...lights.world.table import ENVIRONMENT, MapLight

#: What a shadow map is drawn from: its origin in anchor space, a rotation to map space, and VIRTUAL_LIGHT's map_radius.
SHADOW_MAP_VIEW = np.dtype(
    [("position", "f4", 3), ("map_from_anchor", "f4", (3, 3)), ("map_radius", "f4"), ("light", "i4")]
)

#: Distance from the origin of a parallel map to the middle of the receivers' region, relative to the region's radius.
#: Occluders before the origin are drawn at it.
MAP_DISTANCE = 2.0


def allocate_virtual_lights(
    lights: list[int], importance: np.ndarray, minimum: np.ndarray, count: int
) -> dict[int, int]:
    """How many of `count` virtual lights each of these lights gets, by importance (L,) of all lights.

    Each gets at least `minimum` (L,).
    """
    weights = importance[lights] if importance[lights].any() else np.ones(len(lights))
    additional = proportional_counts(weights, max(count - int(minimum[lights].sum()), 0))
    return {light: int(minimum[light] + number) for light, number in zip(lights, additional, strict=True)}


def virtual_light_tables(
    lights: Lights,
    counts_of_lights: dict[int, int],
    sample: int,
    anchor: np.ndarray,
    region: ReceiverRegion | None = None,
    of_map: MapLight | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows of VIRTUAL_LIGHT_RANGE, of VIRTUAL_LIGHT and of SHADOW_MAP_VIEW for one sample.

    `region`: of the receivers, if there is parallel light; `of_map`: the light of the world's map, if it has one.
    """
    counts = np.array(list(counts_of_lights.values()), int)
    ranges = np.zeros(len(counts), VIRTUAL_LIGHT_RANGE.dtype)
    ranges["light"], ranges["count"] = list(counts_of_lights), counts
    ranges["first"] = np.cumsum(counts) - counts

    light_of = np.repeat(list(counts_of_lights), counts).astype(int)
    shifts = draw(Dimension.VIRTUAL_LIGHT, light=np.arange(len(lights.shape)), sample=sample)
    positions, radii = (lights.position - anchor)[light_of], np.zeros(len(light_of))
    offsets, axes = np.zeros((2, len(light_of), 3))
    for (light, count), first in zip(counts_of_lights.items(), ranges["first"], strict=True):
        rows, light_type, squares = slice(first, first + count), type_of(lights, light), lattice(count, shifts[light])
        if of_map is not None and lights.shape[light] == ENVIRONMENT:
            axes[rows] = -of_map.directions(squares)
        else:
            offsets[rows], axes[rows] = light_type.virtual_lights(lights, light, squares)
        if light_type.parallel and region is not None:
            radii[rows] = region.radius
            offsets[rows] = region.centre - MAP_DISTANCE * region.radius * axes[rows] - positions[rows]
    angle = 2.0 * np.pi * draw(Dimension.MAP_ROTATION, map=sample * len(light_of) + np.arange(len(light_of)))
    tangents, bitangents = orthonormal(axes)
    x_axes = np.cos(angle) * tangents + np.sin(angle) * bitangents
    virtual_lights, views = np.zeros(len(light_of), VIRTUAL_LIGHT.dtype), np.zeros(len(light_of), SHADOW_MAP_VIEW)
    virtual_lights["offset"], virtual_lights["x_axis"], virtual_lights["axis"] = offsets, x_axes, axes
    virtual_lights["map_radius"] = views["map_radius"] = radii
    views["position"] = offsets + positions
    views["map_from_anchor"] = np.stack([x_axes, np.cross(axes, x_axes), axes], 1)
    views["light"] = light_of
    return ranges, virtual_lights, views


class PlaceVirtualLights(Pass):
    """Place virtual lights on the lights: their table, and the range of each light in it."""

    inputs = (
        LIGHT_IMPORTANCE,
        CONTRIBUTING_LIGHTS,
        RECEIVER_REGION,
        BAKED_WORLD,
        Change.LIGHTS,
        Change.SAMPLE,
        "quality.virtual_lights",
    )
    outputs = outputs(VIRTUAL_LIGHT_COUNTS, VIRTUAL_LIGHT_RANGES, VIRTUAL_LIGHTS, SHADOW_MAP_VIEWS)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        lights, counts = frame.scene.lights, dict.fromkeys(frame[CONTRIBUTING_LIGHTS], 0)
        casters = [light for light in counts if frame.casts_shadows and lights.casts_shadow[light]]
        if casters:
            minimum = np.ones(len(lights.shape), int)
            for light_type, rows, _ in by_type(lights):
                minimum[rows] = light_type.min_virtual_lights
            budget = frame.settings.quality.virtual_lights
            counts |= allocate_virtual_lights(casters, frame[LIGHT_IMPORTANCE], minimum, budget)
        baked = frame.get(BAKED_WORLD)
        ranges, virtual_lights, views = virtual_light_tables(
            lights,
            counts,
            frame.sample,
            frame.anchor,
            frame[RECEIVER_REGION],
            None if baked is None else baked.world_light,
        )
        frame[VIRTUAL_LIGHT_COUNTS] = counts
        frame[VIRTUAL_LIGHT_RANGES] = VIRTUAL_LIGHT_RANGE.upload(self.device, ranges)
        frame[VIRTUAL_LIGHTS] = VIRTUAL_LIGHT.upload(self.device, virtual_lights)
        frame[SHADOW_MAP_VIEWS] = views
        frame.counts["virtual_lights"] = len(virtual_lights)
        frame.counts["bytes_uploaded"] += ranges.nbytes + virtual_lights.nbytes
