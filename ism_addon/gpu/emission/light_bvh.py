# SPDX-License-Identifier: GPL-3.0-or-later
"""Light BVHs: hierarchies over emissive triangles, from which shaders choose triangles by importance.

A node has a bounding sphere, and the first moments of its triangles' normals, weighted by area and relative luminance,
from which its area as seen from a direction can be estimated (Conty Estevez & Kulla 2018 bound the normals by a cone
instead). The tree is complete: node k has the children 2k and 2k + 1, the root is 1. Each node splits its triangles at
the median along the longest axis of position and normal, so that nodes become flat as well as small.
"""

from dataclasses import dataclass
from functools import reduce

import numpy as np

from ...parallel import parallel_map
from ..accel.bvh import SHORT_ROW, ascending

#: Maximum number of triangles in a leaf. With 4, 16 samples of the benchmark's scene lanterns have 3 % less error in
#: the same time, but the first sample of 100,000 triangles takes a tenth longer.
MAX_PER_LEAF = 8

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

    The moments are sums over the triangles, weighted by area times relative luminance, which `area` stands for too;
    positions are relative to the centre.
    """

    triangles: np.ndarray  # (leaves * T,) int: the triangles of each leaf; N where a leaf is not full
    leaves: int
    centre: np.ndarray  # (…,3) m: mean position
    radius: np.ndarray  # (…) m: of a bounding sphere about it
    area: np.ndarray  # (…) m²
    normal: np.ndarray  # (…,3) m²
    normal_sine: np.ndarray  # (…) sine of the largest angle of a normal to `normal`; 2: above 90 degrees
    normal_normal: np.ndarray  # (…,6) m²: outer products of the normals, in the order of ELEMENT_AXES
    position_position: np.ndarray  # (…,6) m⁴
    normal_position: np.ndarray  # (…,9) m³, row by row
    color: np.ndarray | None  # (…,3) mean color, if triangles have colors

    @classmethod
    def over(cls, corners: np.ndarray, colors: np.ndarray | None = None) -> "LightBVH":
        """The BVH over triangles (N,3,3) of colors (N,4), see EmissiveLights.colors, or of the same radiance."""
        origin = corners.mean((0, 1))
        # Axes first: numpy is slow along short axes. The last triangle is empty, for leaves that are not full.
        local = np.zeros((3, 3, len(corners) + 1))  # corner, axis, triangle
        np.subtract(corners.transpose(1, 2, 0), origin[:, None], out=local[..., :-1])
        normals, middles = normals_of(local).astype(np.float32), local.sum(0, dtype=np.float32)[:, :-1]
        directions = normals / np.maximum(length(normals), MIN_DIVISOR)
        low, high = middles.min(1), middles.max(1)
        places = (middles - low[:, None]) / max((high - low).max() / 2.0, MIN_DIVISOR)
        leaves = median_leaves(np.concatenate([places, directions[:, :-1]]).T, MAX_PER_LEAF, MIN_LEAVES)
        own_colors = None if colors is None else np.append(colors, np.zeros((1, 4)), 0).T
        count = MOMENTS if own_colors is None else MOMENTS + COLOR_MOMENTS
        sums, low, high = (np.empty((rows, len(leaves))) for rows in (count, 3, 3))

        def fill(first: int) -> None:
            chunk = slice(first, first + LEAVES_AT_A_TIME)
            rows = leaves[chunk].T
            triangles, is_empty = local.take(rows, 2), rows == len(corners)
            own = moments(triangles)
            if own_colors is not None:
                own *= own_colors[3].take(rows)
                own = np.concatenate([own, own[0] * own_colors[:3].take(rows, 1)])
            sums[:, chunk] = own.sum(1)
            low[:, chunk] = np.where(is_empty, np.inf, triangles.min(0)).min(1)
            high[:, chunk] = np.where(is_empty, -np.inf, triangles.max(0)).max(1)

        parallel_map(fill, range(0, len(leaves), LEAVES_AT_A_TIME), len(corners))
        sums, low, high = tree_of(sums, np.add), tree_of(low, np.minimum), tree_of(high, np.maximum)
        area, normal, normal_normal, position, second, mixed, color = np.split(sums, np.cumsum([1, 3, 6, 3, 6, 9]))
        offset = position / np.maximum(area, MIN_DIVISOR)
        extent = np.where(low <= high, np.maximum(high - offset, offset - low), 0.0)
        return cls(
            triangles=leaves.ravel(),
            leaves=len(leaves),
            centre=np.ascontiguousarray(offset.T) + origin,
            radius=length(extent),
            area=area[0],
            normal=np.ascontiguousarray(normal.T),
            normal_sine=normal_sines(normal.astype(np.float32), directions[:, leaves.ravel()]),
            normal_normal=normal_normal.T,
            position_position=(second - position[ELEMENT_AXES[0]] * offset[ELEMENT_AXES[1]]).T,
            normal_position=(mixed - outer(normal, offset)).T,
            color=(color / np.maximum(area, MIN_DIVISOR)).T if len(color) else None,
        )


#: Number of moments of a triangle, and how many more there are with colors.
MOMENTS, COLOR_MOMENTS = 28, 3

#: Leaves whose moments are summed at a time.
LEAVES_AT_A_TIME = 1 << 10

#: Axes of the six elements of a symmetric matrix.
ELEMENT_AXES = np.array([[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]])


def moments(corners: np.ndarray) -> np.ndarray:
    """(MOMENTS,…): the moments about 0 of triangles (3,3,…), corner and axis first.

    Areas, normals (3), products of normals (6), positions (3), products of positions (6), and of normals and positions
    (9). Symmetric ones are in the order of ELEMENT_AXES.
    """
    normals, middles = normals_of(corners), corners.sum(0) / 3.0
    areas = length(normals)
    units, weighted, inner = normals / np.maximum(areas, MIN_DIVISOR), middles * areas, corners - middles
    inner *= np.sqrt(areas / 12.0)
    elements = ELEMENT_AXES.T
    of_normals = [normals[i] * units[j] for i, j in elements]
    of_positions = [middles[i] * weighted[j] + (inner[:, i] * inner[:, j]).sum(0) for i, j in elements]
    return np.stack([areas, *normals, *of_normals, *weighted, *of_positions, *outer(normals, middles)])


def outer(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(9,…): outer products of vectors (3,…), row by row."""
    return (a[:, None] * b[None]).reshape(9, *a.shape[1:])


def length(vectors: np.ndarray) -> np.ndarray:
    """(…): of vectors (3,…)."""
    result: np.ndarray = np.sqrt(vectors[0] ** 2 + vectors[1] ** 2 + vectors[2] ** 2)
    return result


def normals_of(corners: np.ndarray) -> np.ndarray:
    """(3,…) m²: normals times areas of triangles (3,3,…), corner and axis first."""
    (ux, uy, uz), (vx, vy, vz) = corners[1] - corners[0], corners[2] - corners[0]
    return np.stack([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx]) / 2.0


def normal_sines(means: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(2 L,): LightBVH.normal_sine, from mean normals (3,2 L) and the triangles' normals (3,T), 0 without triangle."""
    axes = means / np.maximum(length(means), MIN_DIVISOR)
    count, missing = normals.shape[1], ~normals.any(0)
    sines = np.zeros(means.shape[1], np.float32)

    def fill(first: int) -> None:
        level, each = slice(first, 2 * first), count // first
        cosines = sum(normals[axis].reshape(first, each) * axes[axis, level, None] for axis in range(3))
        cosines[missing.reshape(first, each)] = 1.0
        cosine = cosines.min(1) if each > SHORT_ROW else reduce(np.minimum, cosines.T)
        sines[level] = np.where(cosine > 0.0, np.sqrt(np.maximum(1.0 - cosine * cosine, 0.0)), 2.0)

    levels = means.shape[1].bit_length() - 1
    parallel_map(fill, (1 << level for level in range(levels)), count)
    return sines


def triangle_boxes(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(N,3) low and high corners of the boxes of triangles (N,3,3)."""
    a, b, c = np.moveaxis(corners, 1, 0)  # numpy is slow along short axes
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def normal_areas(corners: np.ndarray) -> np.ndarray:
    """(N,3) m²: normals of triangles (N,3,3) times their areas."""
    return normals_of(np.moveaxis(corners, 0, -1)).T


def median_leaves(points: np.ndarray, max_per_leaf: int, min_leaves: int = 1) -> np.ndarray:
    """(leaves,T) int: neighbouring points (N,K) by leaf of a complete tree; N where a leaf is not full."""
    count, low, high = len(points), points.min(0), points.max(0)
    leaves = max(1 << int(np.ceil(np.log2(max(count / max_per_leaf, 1.0)))), min_leaves)
    rows = np.minimum(np.arange(leaves * -(-count // leaves)), count)[None]
    scale = 65534.0 / max((high - low).max(), 1e-30)
    keys = np.full((count + 1, points.shape[1]), LAST_KEY)  # all of a point together: they are fetched at once
    keys[:count] = np.rint((points - low) * scale - 32767.0)
    first = split(rows, keys, min(leaves, SUBTREES))
    parts = parallel_map(lambda row: split(row[None], keys, leaves // len(first)), first, count)
    return np.concatenate(parts)


def split(rows: np.ndarray, keys: np.ndarray, leaves: int) -> np.ndarray:
    """(leaves,…): rows (R,T) of points, halved until there are so many; `keys` (N + 1,K): the points' coordinates."""
    count = len(keys) - 1
    while len(rows) < leaves:
        present = np.where(rows == count, rows[:, :1], rows)  # slots without a point do not count
        values = keys.take(present.T, 0)  # numpy is slow along short rows
        extents = values.max(0).astype(np.int32) - values.min(0)
        longest = rows * keys.shape[1] + extents.argmax(1)[:, None]
        order = ascending(keys.take(longest))  # slots without a point are last
        rows = np.take_along_axis(rows, order, 1).reshape(2 * len(rows), -1)
    return rows


def tree_of(leaves: np.ndarray, join: np.ufunc) -> np.ndarray:
    """(…,2 L): values of a complete tree's nodes, from those of its leaves (…,L). The first is a copy of the root's."""
    count = leaves.shape[-1]
    nodes = np.empty((*leaves.shape[:-1], 2 * count), leaves.dtype)
    nodes[..., count:] = leaves
    while count > 1:
        count //= 2
        join(
            nodes[..., 2 * count : 4 * count : 2],
            nodes[..., 2 * count + 1 : 4 * count : 2],
            out=nodes[..., count : 2 * count],
        )
    nodes[..., 0] = nodes[..., 1]
    return nodes
