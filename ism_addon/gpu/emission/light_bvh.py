# SPDX-License-Identifier: GPL-3.0-or-later
"""Light BVHs: hierarchies over emissive triangles, from which shaders choose triangles by importance.

A node has a bounding sphere, and the first moments of its triangles' normals, weighted by area, from which its area as
seen from a direction can be estimated (Conty Estevez & Kulla 2018 bound the normals by a cone instead). The tree is
complete: node k has the children 2k and 2k + 1, the root is 1. Each node splits its triangles at the median along the
longest axis of position and normal, so that nodes become flat as well as small.
"""

from dataclasses import dataclass

import numpy as np

#: Maximum number of triangles in a leaf.
MAX_PER_LEAF = 4

#: Minimum number of leaves: shaders estimate irradiance from the nodes at depth 4.
MIN_LEAVES = 16


@dataclass(frozen=True)
class LightBVH:
    """A light BVH over N triangles; arrays of 2 * leaves nodes, of which row 0 is unused.

    The moments are sums over the triangles, weighted by area; positions are relative to the centre.
    """

    triangles: np.ndarray  # (leaves * T,) int: the triangles of each leaf; N where a leaf is not full
    leaves: int
    centre: np.ndarray  # (…,3) m: mean position
    radius: np.ndarray  # (…) m: of a bounding sphere about it
    area: np.ndarray  # (…) m²
    normal: np.ndarray  # (…,3) m²
    normal_sine: np.ndarray  # (…) sine of the largest angle of a normal to `normal`; 2: above 90 degrees
    normal_normal: np.ndarray  # (…,3,3) m²: outer products of the normals
    position_position: np.ndarray  # (…,3,3) m⁴
    normal_position: np.ndarray  # (…,3,3) m³

    @classmethod
    def over(cls, corners: np.ndarray) -> "LightBVH":
        """The BVH over triangles (N,3,3)."""
        normals, middles = normal_areas(corners), corners.mean(1)
        low, high = middles.min(0), middles.max(0)
        places = (middles - low) / max((high - low).max() / 2.0, 1e-30)
        directions = normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
        leaves = median_leaves(np.concatenate([places, directions], 1), MAX_PER_LEAF, MIN_LEAVES)
        origin = middles.mean(0)
        sums = {
            name: tree_of(np.append(values, np.zeros_like(values[:1]), 0)[leaves].sum(1), np.add)
            for name, values in moments(corners - origin, normals).items()
        }
        area, normal, position = sums["area"], sums["normal"], sums["position"]
        offset = position / np.maximum(area, 1e-300)[:, None]
        low, high = np.append(corners.min(1), [[np.inf] * 3], 0), np.append(corners.max(1), [[-np.inf] * 3], 0)
        low, high = tree_of(low[leaves].min(1), np.minimum), tree_of(high[leaves].max(1), np.maximum)
        extent = np.where(low <= high, np.maximum(high - origin - offset, offset + origin - low), 0.0)
        return cls(
            triangles=leaves.ravel(),
            leaves=len(leaves),
            centre=offset + origin,
            radius=np.linalg.norm(extent, axis=1),
            area=area,
            normal=normal,
            normal_sine=normal_sines(normal, np.append(directions, np.zeros((1, 3)), 0)[leaves.ravel()]),
            normal_normal=sums["normal_normal"],
            position_position=sums["position_position"] - outer(position, offset),
            normal_position=sums["normal_position"] - outer(normal, offset),
        )


def normal_sines(means: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(2 L,): LightBVH.normal_sine, from mean normals (2 L,3) and the triangles' normals (T,3), 0 without triangle."""
    lengths = np.linalg.norm(means, axis=1)
    axes, sines, first = means / np.maximum(lengths, 1e-300)[:, None], np.zeros(len(means)), 1
    while first < len(means):
        level = slice(first, 2 * first)
        own = normals.reshape(first, -1, 3)
        cosine = np.where(own.any(2), np.einsum("nti,ni->nt", own, axes[level]), 1.0).min(1)
        sines[level] = np.where(cosine > 0.0, np.sqrt(np.maximum(1.0 - cosine * cosine, 0.0)), 2.0)
        first *= 2
    return sines


def moments(corners: np.ndarray, normals: np.ndarray) -> dict[str, np.ndarray]:
    """Of triangles (N,3,3) with these normals times areas (N,3), the moments of LightBVH, about the origin."""
    areas, middles = np.linalg.norm(normals, axis=1), corners.mean(1)
    inner = corners - middles[:, None]
    within = np.einsum("nci,ncj->nij", inner, inner) * (areas / 12.0)[:, None, None]
    return {
        "area": areas,
        "normal": normals,
        "position": middles * areas[:, None],
        "normal_normal": outer(normals, normals) / np.maximum(areas, 1e-300)[:, None, None],
        "position_position": outer(middles, middles) * areas[:, None, None] + within,
        "normal_position": outer(normals, middles),
    }


def outer(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(N,3,3): outer products of vectors (N,3)."""
    return a[:, :, None] * b[:, None, :]


def normal_areas(corners: np.ndarray) -> np.ndarray:
    """(N,3) m²: normals of triangles (N,3,3) times their areas."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2.0


def median_leaves(points: np.ndarray, max_per_leaf: int, min_leaves: int = 1) -> np.ndarray:
    """(leaves,T) int: neighbouring points (N,K) by leaf of a complete tree; N where a leaf is not full."""
    count = len(points)
    leaves = max(1 << int(np.ceil(np.log2(max(count / max_per_leaf, 1.0)))), min_leaves)
    slots = leaves * -(-count // leaves)
    rows = np.minimum(np.arange(slots), count)[None]
    points = np.concatenate([points, np.full((1, points.shape[1]), np.nan)]).astype(np.float32)
    while len(rows) < leaves:
        values = points[rows]
        with np.errstate(invalid="ignore"):
            longest = (np.fmax.reduce(values, 1) - np.fmin.reduce(values, 1)).argmax(1)
        keys = np.take_along_axis(values, longest[:, None, None], 2)[..., 0]
        order = np.argsort(keys, axis=1, kind="stable")  # slots without a point are last
        rows = np.take_along_axis(rows, order, 1).reshape(2 * len(rows), -1)
    return rows


def tree_of(leaves: np.ndarray, join: np.ufunc) -> np.ndarray:
    """(2 L,…): values of a complete tree's nodes, from those of its leaves (L,…). Row 0 is a copy of the root."""
    levels = [leaves]
    while len(levels[-1]) > 1:
        levels.append(join(levels[-1][::2], levels[-1][1::2]))
    return np.concatenate([levels[-1], *reversed(levels)])
