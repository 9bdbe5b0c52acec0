# SPDX-License-Identifier: GPL-3.0-or-later
"""Reference for imperfect shadow maps: every texel against every disc, pull-push in numpy. Float64, map space."""

import numpy as np


def map_directions(side: int) -> np.ndarray:
    """(side,side,3) unit: the directions of a shadow map's texels, z along the light's normal."""
    x, y = np.meshgrid(*[2.0 * (np.arange(side) + 0.5) / side - 1.0] * 2)
    p, q = 0.5 * (x + y), 0.5 * (x - y)
    directions = np.stack([p, q, 1.0 - np.abs(p) - np.abs(q)], -1)
    return directions / np.linalg.norm(directions, axis=-1, keepdims=True)


def disc_map(centres: np.ndarray, normals: np.ndarray, radii: np.ndarray, side: int, empty: float) -> np.ndarray:
    """(side,side): distance of the nearest of P discs in each texel's direction, or `empty`. Map space."""
    directions = map_directions(side).reshape(-1, 3)
    depth = np.full(len(directions), empty)
    for centre, normal, radius in zip(centres, normals, radii, strict=True):
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = (normal @ centre) / (directions @ normal)
            offset = distance[:, None] * directions - centre
            hit = (distance > 0.0) & ((offset**2).sum(1) <= radius**2)
        depth = np.where(hit, np.minimum(depth, distance), depth)
    return depth.reshape(side, side)


def pull_push(depth: np.ndarray, empty: float, threshold: float, levels: int) -> np.ndarray:
    """(side,side): a shadow map with its holes filled (Marroquim et al. 2007), by coverages, see fill_holes.py."""
    pulled = [(depth, np.where(depth < empty, 1.0, 0.0))]
    for _ in range(levels):
        depths, covers = (groups_of_four(values) for values in pulled[-1])
        near = np.where(covers > 0.0, depths, empty).min(-1, keepdims=True)
        covers = np.where((covers > 0.0) & (depths <= near * (1.0 + threshold)), covers, 0.0)
        cover = covers.sum(-1)
        mean = (depths * covers).sum(-1) / np.maximum(cover, 1e-300)
        pulled.append((np.where(cover > 0.0, mean, empty), 0.25 * cover))
    coarse = pulled[-1]
    for level in reversed(range(levels)):
        coarse = push(pulled[level], coarse, empty, threshold)
    return coarse[0]


def groups_of_four(level: np.ndarray) -> np.ndarray:
    """2×2 texels each: (n,n) to (n/2,n/2,4)."""
    return np.stack([level[j::2, i::2] for j in (0, 1) for i in (0, 1)], -1)


def push(
    fine: tuple[np.ndarray, np.ndarray], coarse: tuple[np.ndarray, np.ndarray], empty: float, threshold: float
) -> tuple[np.ndarray, np.ndarray]:
    """Depth and coverage of the finer level, its holes filled from the four nearest coarser texels."""
    side = len(fine[0])
    position = 0.5 * (np.arange(side) + 0.5) - 0.5
    low = np.floor(position).astype(int)
    fraction = position - low
    neighbours = [np.clip(low + offset, 0, side // 2 - 1) for offset in (0, 1)]
    weight = [1.0 - fraction, fraction]
    four = [(j, i) for j in (0, 1) for i in (0, 1)]
    depths = np.stack([coarse[0][np.ix_(neighbours[j], neighbours[i])] for j, i in four], -1)
    covers = np.stack([coarse[1][np.ix_(neighbours[j], neighbours[i])] for j, i in four], -1)
    weights = np.stack([np.outer(weight[j], weight[i]) for j, i in four], -1)
    near = np.where(covers > 0.0, depths, empty).min(-1, keepdims=True)
    weights = np.where((covers > 0.0) & (depths <= near * (1.0 + threshold)), weights * covers, 0.0)
    cover = weights.sum(-1)
    mean = (weights * depths).sum(-1) / np.maximum(cover, 1e-300)
    hole = (fine[1] <= 0.0) | (fine[0] > mean * (1.0 + threshold))
    filled = hole & (cover > 0.5)
    return np.where(filled, mean, fine[0]), np.where(filled, cover, fine[1])
