# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes and their bounding boxes."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .arrays import UNIT_VECTOR, Arrays, array, index, optional_array
from .limits import MAX_DISTANCE

#: Maximum number of vertices of a mesh whose box is computed together with others.
SMALL_MESH = 1 << 12


@dataclass(frozen=True, eq=False)
class Mesh(Arrays):
    """Triangles in object space. T triangles, V vertices; corners are stored per triangle."""

    positions: np.ndarray = array("float32 V 3", "m", max_abs=MAX_DISTANCE)
    triangles: np.ndarray = index("uint32 T 3", into="positions")
    #: Shading normals of vertices, or of corners.
    normals: np.ndarray = array("float32 V 3 or T 3 3", UNIT_VECTOR)
    #: U is T, or 0 without texture coordinates.
    uvs: np.ndarray = array("float32 U 3 2")
    materials: np.ndarray = index("uint32 T", into="materials")
    #: What the graph of a triangle's material reads at its corners, A of them; B is T, or 0 without any.
    attributes: np.ndarray = optional_array("float32 B 3 A 4")

    @property
    def corner_normals(self) -> np.ndarray:
        """(T,3,3) unit shading normals of the corners."""
        return self.normals if self.normals.ndim == 3 else self.normals[self.triangles]

    @cached_property
    def box(self) -> np.ndarray:
        """(2,3) float64: low and high corner."""
        return np.stack([self.positions.min(0), self.positions.max(0)]).astype(np.float64)

    @cached_property
    def material_indices(self) -> np.ndarray:
        """Its triangles' materials, each once."""
        return np.unique(self.materials)


def bounding_boxes(meshes: Sequence[Mesh]) -> np.ndarray:
    """(M,2,3) float64: Mesh.box of each. Missing boxes of small meshes are computed together."""
    new = [mesh for mesh in meshes if "box" not in vars(mesh) and len(mesh.positions) <= SMALL_MESH]
    if new:
        counts = np.array([len(mesh.positions) for mesh in new])
        positions, first = np.concatenate([mesh.positions for mesh in new]), np.cumsum(counts) - counts
        corners = [min_or_max.reduceat(positions, first, 0) for min_or_max in (np.minimum, np.maximum)]
        for mesh, box in zip(new, np.stack(corners, 1).astype(np.float64), strict=True):
            vars(mesh)["box"] = box  # where cached_property stores it
    return np.concatenate([np.zeros((0, 3)), *(mesh.box for mesh in meshes)]).reshape(-1, 2, 3)
