# SPDX-License-Identifier: GPL-3.0-or-later
"""Curved solids of quads: balls, rounded blocks, tubes along paths, knots. In metres, around the origin."""

from collections.abc import Sequence

import numpy as np

from tests.scenes.parts.shapes import Shape, grid, join, path_length


def ball(radius: float, steps: int, power: float = 2.0) -> Shape:
    """A sphere of 6 × steps² quads without poles. A power above 2 makes it a block with round edges."""
    line = np.tan(np.linspace(-0.25 * np.pi, 0.25 * np.pi, steps + 1))
    u, v = np.meshgrid(line, line, indexing="ij")
    sides = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            cube = np.roll(np.stack([np.full_like(u, sign), u, sign * v], axis=-1), axis, axis=-1)
            norm = (np.abs(cube) ** power).sum(-1, keepdims=True) ** (1.0 / power)
            sides.append(grid(radius * cube / norm, radius * np.stack([u, v], axis=-1)))
    return join(sides)


def rounded_box(low: Sequence[float], high: Sequence[float], radius: float, steps: int = 4) -> Shape:
    """A box between two corners with round edges. Around its flat sides a narrow rim keeps their normals straight."""
    middle, half = 0.5 * np.add(high, low), 0.5 * np.subtract(high, low)
    bend = radius * np.tan(np.linspace(0.0, 0.25 * np.pi, steps + 1))
    rises = [np.concatenate([[max(inner - 0.5 * radius, 0.5 * inner)], inner + bend]) for inner in half - radius]
    lines = [np.concatenate([-rise[::-1], rise]) for rise in rises]
    sides = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            others = (axis + 1) % 3, (axis + 2) % 3
            cube = np.empty((len(lines[others[0]]), len(lines[others[1]]), 3))
            cube[..., others[0]], cube[..., others[1]] = np.meshgrid(*(lines[each] for each in others), indexing="ij")
            cube[..., axis] = sign * half[axis]
            core = np.clip(cube, radius - half, half - radius)
            outwards = cube - core
            positions = core + radius * outwards / np.linalg.norm(outwards, axis=-1, keepdims=True)
            sides.append(grid(middle + positions, (middle + positions)[..., sorted(others)]))
    return join(sides)


def tube(path: np.ndarray, radius: float | np.ndarray, sides: int, closed: bool = False) -> Shape:
    """A tube of `radius` (N,) around a path (N,3). Its ends are open, unless it is closed to a ring."""
    points = np.concatenate([path, path[:1]]) if closed else path
    along = np.gradient(points, axis=0)
    if closed:
        along[0] = along[-1] = points[1] - points[-2]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    across = transported_normals(along)
    if closed:  # distribute the twist between its end and its start over the whole path
        end = across[-1]
        twist = np.arctan2(np.cross(end, across[0]) @ along[0], end @ across[0])
        across = rotated(across, along, np.linspace(0.0, twist, len(points)))
    angles = np.linspace(0.0, 2.0 * np.pi, sides + 1)[None, :, None]
    around = np.cos(angles) * across[:, None] + np.sin(angles) * np.cross(along, across)[:, None]
    radii = np.broadcast_to(np.asarray(radius, float), len(path))
    radii = np.append(radii, radii[0]) if closed else radii
    uvs = np.stack(np.broadcast_arrays(path_length(points)[:, None], angles[..., 0] * radii.max()), axis=-1)
    return grid(points[:, None] + radii[:, None, None] * around, uvs)


def transported_normals(along: np.ndarray) -> np.ndarray:
    """Unit vectors (N,3) perpendicular to directions (N,3): each is the previous one, projected and normalized."""
    across = np.empty_like(along)
    across[0] = np.cross(along[0], np.eye(3)[np.abs(along[0]).argmin()])
    for index in range(len(along)):
        vector = across[max(index - 1, 0)]
        vector = vector - (vector @ along[index]) * along[index]
        across[index] = vector / np.linalg.norm(vector)
    return across


def rotated(across: np.ndarray, along: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Vectors (N,3) rotated about unit axes (N,3) that are perpendicular to them."""
    return np.cos(angles)[:, None] * across + np.sin(angles)[:, None] * np.cross(along, across)


def knot(p: int, q: int, radius: float, thickness: float, steps: int, sides: int) -> Shape:
    """A torus knot that winds p times around the axis and q times through the hole; p = 1, q = 0 is a ring."""
    t = np.linspace(0.0, 2.0 * np.pi, steps, endpoint=False)
    distance = radius * (1.0 + (0.45 * np.cos(q * t) if q else 0.0))
    path = np.stack([distance * np.cos(p * t), distance * np.sin(p * t), -0.45 * radius * np.sin(q * t)], axis=-1)
    return tube(path, thickness, sides, closed=True)


def lowest_point(shape: Shape, rotation: np.ndarray) -> float:
    """Height of the lowest point of a rotated shape."""
    return float((shape.positions @ rotation[2]).min())
