# SPDX-License-Identifier: GPL-3.0-or-later
"""Connected parts of meshes, and which of them are closed."""

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from ...scene import Mesh
from .light_bvh import triangle_boxes


@dataclass(frozen=True)
class MeshParts:
    """The parts of a mesh. Triangles that share a corner are connected."""

    part: np.ndarray  # (T,) int: index of each triangle's part
    #: (P,) 1: closed, and its triangles are counterclockwise as seen from outside; -1: clockwise; 0: not closed.
    side: np.ndarray
    boxes: np.ndarray  # (P,2,3) float64 m, object space


#: Size of the grid on which vertices are at the same place, relative to the mesh: more than rounding errors.
WELD_DISTANCE = 1e-6

#: More than the places on this grid along an axis.
PLACES = 1 << 20

#: Of meshes that exist.
_CACHE: WeakKeyDictionary[Mesh, MeshParts] = WeakKeyDictionary()


def parts_of(mesh: Mesh) -> MeshParts:
    """The parts of a mesh; computed once."""
    if mesh not in _CACHE:
        # Vertices at the same place are one: seams of texture coordinates or of sharp edges may be in between.
        size = max(float((mesh.box[1] - mesh.box[0]).max()), 1e-30)
        places = np.rint((mesh.positions - mesh.box[0]) / (WELD_DISTANCE * size)).astype(np.int64)
        _, vertices = np.unique(places @ (1, PLACES, PLACES**2), return_inverse=True)
        _CACHE[mesh] = find_parts(mesh.positions[mesh.triangles].astype(np.float64), vertices.ravel()[mesh.triangles])
    return _CACHE[mesh]


def find_parts(corners: np.ndarray, triangles: np.ndarray) -> MeshParts:
    """The parts of triangles with corners (T,3,3) m and indices of vertices (T,3)."""
    part = connected(triangles)
    count = part.max() + 1
    order = np.argsort(part, kind="stable")
    starts = np.searchsorted(part[order], np.arange(count))
    low, high = triangle_boxes(corners[order])
    low, high = np.minimum.reduceat(low, starts), np.maximum.reduceat(high, starts)
    a, b, c = np.moveaxis(corners - ((low + high) / 2.0)[part][:, None], 1, 0)
    volume = np.bincount(part, np.einsum("ti,ti->t", a, np.cross(b, c)), count)
    part_of_vertex = np.empty(triangles.max() + 1, int)
    part_of_vertex[triangles] = part[:, None]
    is_open = np.zeros(count, bool)
    is_open[part_of_vertex[at_open_edges(triangles)]] = True
    return MeshParts(part, np.where(is_open, 0.0, np.sign(volume)), np.stack([low, high], 1))


def connected(triangles: np.ndarray) -> np.ndarray:
    """(T,) int from 0 on: equal for connected triangles (T,3).

    Each vertex has a label, at first itself, in the end the smallest of all connected vertices. In each round, the
    higher label at each edge takes the lower one as its own label, and all labels are followed to their ends.
    """
    labels = np.arange(triangles.max() + 1)
    start, end = triangles[:, :2].ravel(), triangles[:, 1:].ravel()
    while True:
        one, other = labels[start], labels[end]
        differ = one != other
        if not differ.any():
            return np.unique(labels[triangles[:, 0]], return_inverse=True)[1].ravel()
        start, end, one, other = start[differ], end[differ], one[differ], other[differ]
        labels[np.maximum(one, other)] = np.minimum(one, other)
        while not np.array_equal(followed := labels[labels], labels):
            labels = followed


def at_open_edges(triangles: np.ndarray) -> np.ndarray:
    """(K,) int: a vertex of each edge that does not have exactly two triangles (T,3) of the same orientation."""
    start, end, vertices = triangles.ravel(), np.roll(triangles, -1, 1).ravel(), int(triangles.max()) + 1
    # Pairs of vertices, and the direction in the last bit: the two triangles of an edge have consecutive numbers.
    keys = (np.minimum(start, end) * vertices + np.maximum(start, end)) << 1 | (start > end)
    # Welding may have left triangles without area, and edges without length.
    keys = np.sort(keys[start != end] if (start == end).any() else keys)
    edges = keys >> 1
    first = np.flatnonzero(np.append(True, edges[1:] != edges[:-1])) if len(keys) else np.zeros(0, int)
    pairs = np.diff(first, append=len(keys)) == 2
    pairs[pairs] = keys[first[pairs] + 1] == keys[first[pairs]] + 1
    return edges[first[~pairs]] // vertices
