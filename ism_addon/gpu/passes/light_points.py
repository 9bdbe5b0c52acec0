# SPDX-License-Identifier: GPL-3.0-or-later
"""Virtual point lights inside the area lights: other ones each sample.

Beck-Norén & Valter 2013, section 3.1. The light points of a sample are shared out by power, at least one a
light; a light's radiance and area are exact (see gather), its points only say how much of it is visible.
"""

import numpy as np

from ...radiometry import light_areas, spread_terms
from ...sampling import additive_sequence, points_on_light, shares
from ...scene import Change, Lights
from ...spaces import orthonormal
from ..layout import LIGHT, LIGHT_POINT
from . import Frame, Pass

#: Rec.709 luminance.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def points_per_light(lights: Lights, count: int) -> np.ndarray:
    """(L,) int64: `count` light points by the lights' power; never none, so a few more where lights are many."""
    power = np.abs(lights.radiance @ LUMINANCE) * light_areas(lights)
    return 1 + shares(power, max(count - len(power), 0))


def light_tables(
    lights: Lights, count: int, sample: int, anchor: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows of LIGHT and of LIGHT_POINT for one sample, and the light of each light point."""
    counts = points_per_light(lights, count)
    first = np.cumsum(counts) - counts
    table = np.zeros(len(counts), LIGHT.dtype)
    table["position"] = lights.position - anchor
    for name in ("shape", "axis_u", "axis_v", "normal", "casts_shadow", "radiance"):
        table[name] = getattr(lights, name)
    table["first_point"], table["point_count"] = first, counts
    table["spread_tangent"], table["spread_scale"] = spread_terms(lights.spread).T

    points = np.zeros(counts.sum(), LIGHT_POINT.dtype)
    turns = additive_sequence(sample * len(points), len(points), 1)[:, 0]
    for light, (start, number) in enumerate(zip(first, counts, strict=True)):
        shift = additive_sequence(sample, 1, 2)[0] + additive_sequence(light, 1, 2)[0]
        rows = slice(start, start + number)
        points["position"][rows] = points_on_light(lights, light, number, shift) - anchor
        tangent, bitangent = orthonormal(lights.normal[light])
        angle = 2.0 * np.pi * turns[rows, None]
        points["tangent"][rows] = np.cos(angle) * tangent + np.sin(angle) * bitangent
        points["normal"][rows] = lights.normal[light]
    return table, points, np.repeat(np.arange(len(counts)), counts)


class LightPoints(Pass):
    """The tables of lights and of light points."""

    makes = ("lights", "light_points", "light_of_point")
    settings = ("quality.light_points",)
    depends_on = (Change.LIGHTS, Change.SAMPLE)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def draw(self, frame: Frame) -> None:
        lights, points, owners = light_tables(
            frame.scene.lights, frame.settings.quality.light_points, frame.sample, frame.anchor
        )
        frame.tables["lights"] = LIGHT.upload(self.device.gl, lights)
        frame.tables["light_points"] = LIGHT_POINT.upload(self.device.gl, points)
        frame.tables["light_of_point"] = owners
        frame.counts["light_points"] = len(points)
        frame.counts["bytes_uploaded"] += lights.nbytes + points.nbytes
