# SPDX-License-Identifier: GPL-3.0-or-later
"""The sun in a map of all directions, taken out as a light of its own (as regions of a map by Debevec 2005).

A shadow that it casts has a penumbra of its size, which few samples of the whole map resolve. It has one color: what of
its texels is of another one stays in the map, as does what is around it. Both are interpolated linearly between texels,
so together they are the map.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from .equirectangular import directions_at

#: A sun is brighter than this multiple of the map's mean, and gives at least this fraction of its light.
MIN_CONTRAST, MIN_FRACTION = 16.0, 0.05
#: It has texels within this angle of its middle, rad, of at least this fraction of the brightest one's luminance. The
#: median of those up to the larger angle is what stays.
RADIUS, SURROUNDINGS = np.radians(3.0), np.radians(4.5)
MIN_BRIGHTNESS = 0.05


@dataclass(frozen=True, eq=False)
class MapSun:
    """A sun in a map."""

    direction: np.ndarray  # (3,) unit, to its middle
    irradiance: np.ndarray  # (3,) W/m², of a surface that faces it
    angular_diameter: float  # rad, of an even disc that is as wide
    first_texel: tuple[int, int]  # row and column in the map
    radiance: np.ndarray  # (R,C) float32: luminance of its texels, which light a surface that faces them by 1
    probability: np.ndarray  # (R,C) float32, in proportion to the irradiance of each


@dataclass(frozen=True, eq=False)
class Window:
    """A part of a map of H × W texels: some rows of all or some columns, which may go across the map's edge."""

    rows: np.ndarray  # (R,1) indices
    columns: np.ndarray  # (C,)
    directions: np.ndarray  # (R,C,3) unit
    solid_angles: np.ndarray  # (R,1) sr
    texel: np.ndarray  # (R,1): half the sum of a texel's squared sides, rad²

    @classmethod
    def around(cls, row: int, column: int, height: int, width: int) -> "Window":
        """All texels within SURROUNDINGS of a middle that is within 2 RADIUS of a texel, and some more."""
        angle = 2.0 * RADIUS + SURROUNDINGS
        reach = int(np.ceil(angle * height / pi))
        rows = np.arange(max(row - reach, 0), min(row + reach + 1, height))[:, None]
        sine = np.sin(pi * (rows + 0.5) / height)
        across = int(min(np.ceil(angle / sine.min() * width / (2.0 * pi)), (width - 1) // 2))
        columns = np.arange(column - across, column + across + 1) % width
        sides = pi / height, 2.0 * pi / width * sine
        directions = directions_at(rows[:, 0], columns, height, width)
        return cls(rows, columns, directions, sides[0] * sides[1], 0.5 * (sides[0] ** 2 + sides[1] ** 2))


def without_sun(radiance: np.ndarray, luminance: np.ndarray) -> tuple[np.ndarray, MapSun | None]:
    """A map (H,W,3) without its sun, and the sun, if it has one. `luminance` (3,) of the working space's primaries."""
    height, width = radiance.shape[:2]
    light = radiance @ luminance.astype(np.float32)
    row, column = divmod(int(light.argmax()), width)
    weight = np.sin(pi * (np.arange(height) + 0.5) / height)
    total = float(light.mean(1, dtype=np.float64) @ weight) * 2.0 * pi * pi / height
    brightest = float(light[row, column])
    if not brightest > MIN_CONTRAST * total / (4.0 * pi):
        return radiance, None
    window = Window.around(row, column, height, width)
    part = radiance[window.rows, window.columns].astype(np.float64)
    color, excess = excess_of(part, light[window.rows, window.columns].astype(np.float64), window)
    of_texels = excess * window.solid_angles
    if not of_texels.sum() >= MIN_FRACTION * total:
        return radiance, None
    used = [np.flatnonzero(excess.any(axis)) for axis in (1, 0)]
    inner = np.s_[used[0][0] : used[0][-1] + 1, used[1][0] : used[1][-1] + 1]
    if window.rows[inner[0]].min() == 0 or window.rows[inner[0]].max() == height - 1:
        return radiance, None  # beyond a pole, texels have no neighbors in the map's grid
    rest = radiance.copy()
    rest[window.rows, window.columns] = np.maximum(part - excess[..., None] * color, 0.0)
    return rest, sun_of(window, color, excess, inner)


def excess_of(part: np.ndarray, light: np.ndarray, window: Window) -> tuple[np.ndarray, np.ndarray]:
    """The sun's color (3,), of luminance 1, and how much of it the texels of a window have, (R,C).

    `part` (R,C,3) and `light` (R,C): the radiance of the window's texels, and its luminance.
    """
    is_bright = light >= MIN_BRIGHTNESS * light.max()
    brightest = window.directions[np.unravel_index(light.argmax(), light.shape)]
    near = is_bright * light * window.solid_angles * (window.directions @ brightest >= np.cos(2.0 * RADIUS))
    middle = np.einsum("rc,rck->k", near, window.directions)
    cosine = window.directions @ (middle / np.linalg.norm(middle))
    is_sun = (cosine >= np.cos(RADIUS)) & is_bright
    is_around = (cosine < np.cos(RADIUS)) & (cosine >= np.cos(SURROUNDINGS))
    around = np.median(part[is_around], 0) if is_around.any() else np.zeros(3)
    more = np.maximum(part - around, 0.0) * is_sun[..., None]
    color = (more * window.solid_angles[..., None]).sum((0, 1))
    color /= max(float((light * is_sun * window.solid_angles).sum()), 1e-300)
    with np.errstate(divide="ignore", invalid="ignore"):
        multiples = np.where(color > 0.0, more / color, np.inf).min(2)
    return color, np.where(np.isfinite(multiples), multiples, 0.0)


def sun_of(window: Window, color: np.ndarray, excess: np.ndarray, inner: tuple[slice, slice]) -> MapSun:
    """The sun of a color (3,) of which the texels of a window have so much, (R,C); all of it in its `inner` part."""
    of_texels = excess * window.solid_angles
    vector = np.einsum("rc,rck->k", of_texels, window.directions)
    irradiance = float(np.linalg.norm(vector))
    direction = vector / irradiance
    off = window.directions - direction
    # The mean square from the middle, of texels and of the linear interpolation between them; half of a disc's radius².
    square = float((of_texels * ((off * off).sum(2) + window.texel / 3.0)).sum() / of_texels.sum())
    rows, columns = window.rows[inner[0]][0, 0], window.columns[inner[1]][0]
    return MapSun(
        direction,
        irradiance * color,
        2.0 * float(np.sqrt(2.0 * square)),
        (int(rows), int(columns)),
        (excess[inner] / irradiance).astype(np.float32),
        (of_texels[inner] / of_texels.sum()).astype(np.float32),
    )
