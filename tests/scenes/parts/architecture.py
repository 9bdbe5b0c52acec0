# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a stone building: arcades, pillars, vaults, balustrades. In metres; each stands on z = 0."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from tests.scenes.parts.shapes import Shape, box, grid, join, lathe, path_length, ring

POLE = 0.004  # m, half width of a hole at the axis of a cap: without it, quads there would be degenerate


def wall_over_arches(
    start: float,
    end: float,
    centres: Sequence[float],
    radius: float,
    heights: tuple[float, float],
    thickness: float,
    steps: int = 28,
) -> Shape:
    """A closed wall along x, centred on y = 0. Its lower edge follows round arches."""
    springing, top = heights
    angles = np.linspace(np.pi, 0.0, steps + 1)
    arches = [np.stack([c + radius * np.cos(angles), springing + radius * np.sin(angles)], -1) for c in centres]
    edge = np.concatenate([[(start, springing)], *arches, [(end, springing)]])
    ceiling = np.stack([edge[:, 0], np.full(len(edge), top)], axis=-1)
    half = 0.5 * thickness
    corners = [(edge, -half), (ceiling, -half), (ceiling, half), (edge, half), (edge, -half)]
    sides = []
    for (line, y), (next_line, next_y) in pairwise(corners):
        rows = np.stack([at_depth(line, y), at_depth(next_line, next_y)])
        flat = y == next_y
        uvs = [row[:, [0, 2]] if flat else np.stack([path_length(line), row[:, 1]], axis=-1) for row in rows]
        sides.append(grid(rows, np.stack(uvs)))
    for x, order in ((start, 1), (end, -1)):
        y, z = np.array([[half, -half], [half, -half]])[:, ::order], np.array([[springing] * 2, [top] * 2])
        sides.append(grid(np.stack([np.full((2, 2), x), y, z], axis=-1), np.stack([y, z], axis=-1)))
    return join(sides)


def at_depth(line: np.ndarray, y: float) -> np.ndarray:
    """(N,3): points (N,2) of x and z, at one y."""
    return np.stack([line[:, 0], np.full(len(line), y), line[:, 1]], axis=-1)


def archivolt(radius: float, width: float, thickness: float, steps: int = 28) -> Shape:
    """The moulding around an arch. It projects from both sides of a wall along x; its centre is the origin."""
    half = 0.5 * thickness
    # A centimetre in front of the wall: if two faces were coplanar, rounding would decide which one shadows the other.
    profile = np.array([(0.0, -0.01), (0.35, -0.01), (0.4, -0.02), (0.85, -0.02), (1.0, 0.06)]) - (0.0, half)
    profile = np.concatenate([profile, profile[::-1] * (1.0, -1.0)])
    profile = profile[::-1] * (width, 1.0) + (radius - 0.02, 0.0)
    angles = np.linspace(0.0, np.pi, steps + 1)
    r, y = profile[:, 0], np.broadcast_to(profile[:, 1], (steps + 1, len(profile)))
    positions = np.stack([np.cos(angles)[:, None] * r, y, np.sin(angles)[:, None] * r], axis=-1)
    uvs = np.stack(np.broadcast_arrays(path_length(profile), radius * angles[:, None]), axis=-1)
    return grid(positions, uvs)


def curve(*pieces: tuple[tuple[float, float], tuple[float, float], float]) -> np.ndarray:
    """A profile of (radius, height) from pieces: two ends, and how far the piece bulges out (negative: in)."""
    points = []
    for start, end, bulge in pieces:
        steps = np.linspace(0.0, 1.0, 6 if bulge else 2)[:, None]
        line = (1.0 - steps) * start + steps * np.array(end)
        points.append(line + np.sin(np.pi * steps) * (bulge, 0.0))
    joined = np.concatenate(points)
    distinct = np.concatenate([[True], np.linalg.norm(np.diff(joined, axis=0), axis=1) > 1e-6])
    return joined[distinct]


def pillar(height: float, radius: float, abacus: float, flutes: int) -> tuple[Shape, Shape]:
    """A round pillar: its shaft with entasis; and its base and capital."""
    r = radius
    base_top, neck = 0.16 + 0.6 * r, height - 0.16 - 1.5 * r
    t = np.linspace(0.0, 1.0, 11)
    swell = r * (1.0 - 0.16 * t + 0.055 * np.sin(np.pi * t))
    shaft = np.stack([swell, base_top + (neck - base_top) * t], axis=-1)
    depth = 0.07 * r * np.clip(8.0 * np.minimum(t, 1.0 - t), 0.0, 1.0) if flutes else 0.0
    base = curve(
        ((1.3 * r, 0.15), (1.3 * r, 0.15 + 0.28 * r), 0.1 * r),
        ((1.18 * r, 0.15 + 0.3 * r), (1.1 * r, 0.15 + 0.42 * r), -0.07 * r),
        ((1.1 * r, 0.15 + 0.42 * r), (1.05 * r, base_top + 0.02), 0.06 * r),
    )
    top = height - 0.13
    collar = curve(
        ((0.8 * r, neck - 0.06), (0.84 * r, neck), 0.09 * r), ((0.84 * r, neck), (0.86 * r, neck + 0.02), 0.0)
    )
    bell_height = np.linspace(neck + 0.02, top, 13)
    s = np.linspace(0.0, 1.0, 13)
    bell = np.stack([r * (0.86 + 0.62 * s**2.2 + 0.1 * np.sin(3.0 * np.pi * s) * (1.0 - s)), bell_height], axis=-1)
    capital = join(
        [
            lathe(collar, 32),
            lathe(bell, 32, lobes=8, depth=0.16 * r * np.sin(np.pi * np.clip(s * 1.1, 0.0, 1.0)) ** 0.7),
            slab(0.5 * abacus, height - 0.14, height + 0.01),
        ]
    )
    foot = join([slab(1.42 * r, -0.02, 0.16), lathe(base, 32)])
    return lathe(shaft, 4 * flutes if flutes else 32, flutes, depth), join([foot, capital])


def slab(half: float, low: float, high: float) -> Shape:
    """A square plate whose upper edge is bevelled, so that it catches light."""
    c = min(0.015, 0.2 * (high - low))
    return ring([(POLE, low), (half, low), (half, high - c), (half - c, high), (POLE, high)], 0.0, 0.0)


def pier(height: float, half: float) -> Shape:
    """A square pier with a foot and an impost."""
    h = half
    profile = [(POLE, -0.02), (h + 0.05, -0.02), (h + 0.05, 0.22), (h + 0.02, 0.26), (h, 0.28)]
    profile += [(h, height - 0.24), (h + 0.03, height - 0.2), (h + 0.03, height - 0.12), (h + 0.07, height - 0.08)]
    profile += [(h + 0.07, height + 0.012), (POLE, height + 0.012)]
    return ring(profile, 0.0, 0.0)


def groin_vault(half_x: float, half_y: float, springing: float, rise: float, steps: int = 20) -> Shape:
    """Two barrel vaults that cross above a bay, centred on the origin. Their crown is `rise` above the springing."""
    s = np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, steps + 1))
    x, y = np.meshgrid(s, s, indexing="ij")
    z = springing + rise * np.sqrt(1.0 - np.minimum(x**2, y**2))
    return grid(np.stack([half_x * x, half_y * y, z], -1), np.stack([half_x * x, half_y * y], -1))


def balustrade(length: float, count: int) -> Shape:
    """Rails and balusters along x, centred on the origin, 0.95 m high."""
    h = 0.5 * length
    profile = curve(
        ((0.05, 0.17), (0.05, 0.2), 0.012),
        ((0.034, 0.22), (0.036, 0.56), 0.042),
        ((0.036, 0.56), (0.044, 0.62), -0.006),
        ((0.056, 0.63), (0.056, 0.67), 0.012),
        ((0.044, 0.68), (0.062, 0.8), -0.014),
    )
    baluster = lathe(profile, 8)
    positions = (np.arange(count) + 0.5) / count * length - h
    rail = [(-0.09, 0.785), (0.02, 0.785), (0.05, 0.83), (0.05, 0.92), (0.03, 0.95), (-0.09, 0.95)]
    foot = box((-h, -0.12, -0.02), (h, 0.12, 0.18))
    return join([ring(rail, h, 0.095), foot, *(baluster.moved(x=x) for x in positions)])


def urn(height: float) -> Shape:
    """A big jar, open at the top, with a thick wall."""
    k = height
    return lathe(
        curve(
            ((0.001, 0.0), (0.2 * k, 0.0), 0.0),
            ((0.2 * k, 0.0), (0.2 * k, 0.05 * k), 0.02 * k),
            ((0.17 * k, 0.06 * k), (0.3 * k, 0.62 * k), 0.12 * k),
            ((0.3 * k, 0.62 * k), (0.2 * k, 0.86 * k), 0.06 * k),
            ((0.2 * k, 0.86 * k), (0.27 * k, 0.97 * k), -0.03 * k),
            ((0.27 * k, 0.97 * k), (0.22 * k, 0.98 * k), 0.0),
            ((0.22 * k, 0.98 * k), (0.16 * k, 0.84 * k), 0.0),
            ((0.16 * k, 0.84 * k), (0.001, 0.3 * k), 0.1 * k),
        ),
        36,
    )
