# SPDX-License-Identifier: GPL-3.0-or-later
"""Light BVHs: hierarchies over emissive triangles, from which shaders choose triangles by importance.

A node has a bounding sphere, and the first moments of its triangles' normals, weighted by area, from which its area as
seen from a direction can be estimated (Conty Estevez & Kulla 2018 bound the normals by a cone instead). The tree is
complete: node k has the children 2k and 2k + 1, the root is 1. Each node splits its triangles at the median along the
longest axis of position and normal, so that nodes become flat as well as small.
"""

from dataclasses import dataclass
from functools import reduce

import numpy as np

from ...parallel import parallel_map
from ..accel.bvh import SHORT_ROW, ascending

#: Maximum number of triangles in a leaf.
MAX_PER_LEAF = 4

#: Subtrees that are built in parallel.
SUBTREES = 8

#: Key of slots without a point, which are sorted to the end.
LAST_KEY = np.int16(32767)

#: Instead of 0, to divide by.
MIN_DIVISOR = np.float32(1e-30)

#: Minimum number of leaves: shaders estimate irradiance from up to as many nodes, see lights/emissive_mesh.glsl.
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
        origin = corners.mean((0, 1))
        exact = with_empty_row(corners - origin)  # moments of positions need its digits: they nearly cancel
        local = exact.astype(np.float32)
        normals, middles = normal_areas(local), local.mean(1)
        low, high = middles.min(0), middles.max(0)
        places = (middles - low) / max((high - low).max() / 2.0, MIN_DIVISOR)
        directions = normals / np.maximum(np.linalg.norm(normals, axis=1), MIN_DIVISOR)[:, None]
        leaves = median_leaves(np.concatenate([places, directions], 1)[:-1], MAX_PER_LEAF, MIN_LEAVES)
        sums = tree_sums(moments_of_normals(normals), leaves) | tree_sums(moments_of_positions(exact, normals), leaves)
        area, normal, position = sums["area"], sums["normal"], sums["position"]
        offset = position / np.maximum(area, MIN_DIVISOR)[:, None]
        low, high = triangle_boxes(local)
        low[-1], high[-1] = np.inf, -np.inf
        low = tree_of(reduce(np.minimum, (low[column] for column in leaves.T)), np.minimum)
        high = tree_of(reduce(np.maximum, (high[column] for column in leaves.T)), np.maximum)
        extent = np.where(low <= high, np.maximum(high - offset, offset - low), np.float32(0.0))
        return cls(
            triangles=leaves.ravel(),
            leaves=len(leaves),
            centre=offset + origin,
            radius=np.linalg.norm(extent, axis=1),
            area=area,
            normal=normal,
            normal_sine=normal_sines(normal, directions[leaves.ravel()]),
            normal_normal=sums["normal_normal"],
            position_position=sums["position_position"] - outer(position, offset),
            normal_position=sums["normal_position"] - outer(normal, offset),
        )


def with_empty_row(rows: np.ndarray) -> np.ndarray:
    """(N + 1,…): rows (N,…) and one of zeros."""
    result = np.zeros((len(rows) + 1, *rows.shape[1:]), rows.dtype)
    result[:-1] = rows
    return result


def normal_sines(means: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(2 L,): LightBVH.normal_sine, from mean normals (2 L,3) and the triangles' normals (T,3), 0 without triangle."""
    axes = means / np.maximum(np.linalg.norm(means, axis=1), MIN_DIVISOR)[:, None]
    sines, missing = np.zeros(len(means), np.float32), ~normals.any(1)

    def fill(first: int) -> None:
        level, each = slice(first, 2 * first), len(normals) // first
        cosines = np.einsum("nti,ni->nt", normals.reshape(first, each, 3), axes[level])
        cosines[missing.reshape(first, each)] = 1.0
        cosine = cosines.min(1) if each > SHORT_ROW else reduce(np.minimum, cosines.T)
        sines[level] = np.where(cosine > 0.0, np.sqrt(np.maximum(1.0 - cosine * cosine, 0.0)), 2.0)

    levels = len(means).bit_length() - 1
    parallel_map(fill, (1 << level for level in range(levels)), len(normals))
    return sines


def moments_of_normals(normals: np.ndarray) -> dict[str, np.ndarray]:
    """The moments of LightBVH without positions, of triangles with normals times areas (N,3)."""
    areas = np.linalg.norm(normals, axis=1)
    return {
        "area": areas,
        "normal": normals,
        "normal_normal": outer(normals, normals / np.maximum(areas, MIN_DIVISOR)[:, None]),
    }


def moments_of_positions(corners: np.ndarray, normals: np.ndarray) -> dict[str, np.ndarray]:
    """Those with positions, about 0, of triangles (N,3,3)."""
    areas, middles = np.linalg.norm(normals, axis=1)[:, None], corners.mean(1)
    inner = corners - middles[:, None]
    within = np.einsum("nci,ncj->nij", inner, inner) * (areas / 12.0)[..., None]
    return {
        "position": middles * areas,
        "position_position": outer(middles, middles * areas) + within,
        "normal_position": outer(normals, middles),
    }


def outer(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(N,3,3): outer products of vectors (N,3)."""
    return a[:, :, None] * b[:, None, :]


def triangle_boxes(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(N,3) low and high corners of the boxes of triangles (N,3,3)."""
    a, b, c = np.moveaxis(corners, 1, 0)  # numpy is slow along short axes
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def normal_areas(corners: np.ndarray) -> np.ndarray:
    """(N,3) m²: normals of triangles (N,3,3) times their areas."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2.0


def median_leaves(points: np.ndarray, max_per_leaf: int, min_leaves: int = 1) -> np.ndarray:
    """(leaves,T) int: neighbouring points (N,K) by leaf of a complete tree; N where a leaf is not full."""
    count, low, high = len(points), points.min(0), points.max(0)
    leaves = max(1 << int(np.ceil(np.log2(max(count / max_per_leaf, 1.0)))), min_leaves)
    rows = np.minimum(np.arange(leaves * -(-count // leaves)), count)[None]
    scale = 65534.0 / max((high - low).max(), 1e-30)
    keys = np.full((points.shape[1], count + 1), LAST_KEY)
    keys[:, :count] = np.rint((points - low) * scale - 32767.0).T
    first = split(rows, keys, min(leaves, SUBTREES))
    parts = parallel_map(lambda row: split(row[None], keys, leaves // len(first)), first, count)
    return np.concatenate(parts)


def split(rows: np.ndarray, keys: np.ndarray, leaves: int) -> np.ndarray:
    """(leaves,…): rows (R,T) of points, halved until there are so many; `keys` (K,N + 1): the points' coordinates."""
    count = keys.shape[1] - 1
    while len(rows) < leaves:
        present = np.where(rows == count, rows[:, :1], rows)  # slots without a point do not count
        values = keys[:, present.T]  # numpy is slow along short rows
        extents = values.max(1).astype(np.int32) - values.min(1)
        order = ascending(keys[extents.argmax(0)[:, None], rows])  # slots without a point are last
        rows = np.take_along_axis(rows, order, 1).reshape(2 * len(rows), -1)
    return rows


def tree_sums(values: dict[str, np.ndarray], leaves: np.ndarray) -> dict[str, np.ndarray]:
    """Sums over a complete tree's nodes, (2 L,…) each, of values (N,…) of its triangles by leaf (L,T)."""
    widths = [int(np.prod(each.shape[1:])) for each in values.values()]
    table = np.concatenate([each.reshape(len(each), -1) for each in values.values()], 1)
    sums = tree_of(sum(table[column] for column in leaves.T), np.add)
    parts = np.split(sums, np.cumsum(widths)[:-1], 1)
    return {name: part.reshape(-1, *each.shape[1:]) for part, (name, each) in zip(parts, values.items(), strict=True)}


def tree_of(leaves: np.ndarray, join: np.ufunc) -> np.ndarray:
    """(2 L,…): values of a complete tree's nodes, from those of its leaves (L,…). Row 0 is a copy of the root."""
    levels = [leaves]
    while len(levels[-1]) > 1:
        levels.append(join(levels[-1][::2], levels[-1][1::2]))
    return np.concatenate([levels[-1], *reversed(levels)])
