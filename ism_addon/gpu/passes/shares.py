# SPDX-License-Identifier: GPL-3.0-or-later
"""How many light points each light has: by what they change.

Points say what part of a light arrives. They err in its penumbrae, which are as wide as the light is seen large, by a
part of what it brings there. For a given number of points, as many in proportion to the root of the mean of the
squared error leave the least of it (Neyman 1934). A light that can change nothing has none, and neither has one
that casts no shadow. Weights are powers of two, so that a small move of the camera changes no light's points.
"""

import numpy as np

from ...sampling import shares
from ...scene import Change
from ..bounds import Lamps
from . import Frame, Pass


def weights(guess: np.ndarray, lamps: Lamps) -> np.ndarray:
    """(K,) of K lamps, powers of two, by the irradiance (K,rows,columns) that they are thought to bring to blocks."""
    light = guess.sum(0)
    if not light.any():
        return np.zeros(len(guess))
    part = guess / np.maximum(light, light[light > 0.0].mean())
    full = np.pi * (lamps.luminance * lamps.peak)[..., None]
    size = np.sqrt(np.minimum(np.divide(guess, full, out=np.zeros_like(guess), where=full > 0.0), 1.0))
    deviation = np.sqrt((part * part * size).sum((1, 2), dtype=np.float64))
    with np.errstate(divide="ignore"):
        return np.exp2(np.rint(np.log2(deviation / deviation.max())))


class Shares(Pass):
    """The lights that count, and how many light points each has."""

    reads = ("reach", "guess")
    makes = ("points_per_light",)
    settings = ("shadow.enabled", "quality.light_points")
    depends_on = (Change.LIGHTS, Change.INSTANCES)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0 and not frame.fitted

    def draw(self, frame: Frame) -> None:
        lights, counts = frame.scene.lights, dict.fromkeys(sorted(frame.tables["reach"]), 0)
        wanting = [light for light in counts if frame.splats and lights.casts_shadow[light]]
        weight = weights(frame.tables["guess"], Lamps.of(lights, frame.anchor))[wanting]
        known = weight if weight.any() else np.ones_like(weight)  # where lights do no more than graze what is seen
        more = shares(known, max(frame.settings.quality.light_points - len(wanting), 0))
        counts |= {light: 1 + int(number) for light, number in zip(wanting, more, strict=True)}
        frame.tables["points_per_light"] = counts
