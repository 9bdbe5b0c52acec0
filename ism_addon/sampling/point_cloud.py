# SPDX-License-Identifier: GPL-3.0-or-later
"""Random points on all triangles that cast shadows, in proportion to their world area."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ..scene import Mesh, Scene
from .points import points_on_triangles, proportional_counts, triangle_areas

#: Points that are computed at a time.
POINTS_AT_A_TIME = 1 << 17


@dataclass(frozen=True)
class PointCloud:
    """P points; each stands for `area` m². Anchor space."""

    positions: np.ndarray  # (P,3) float32
    normals: np.ndarray  # (P,3) float32
    instances: np.ndarray  # (P,) int: the scene's index of the instance that they are on
    triangles: np.ndarray  # (P,) int: the mesh's index of the triangle
    groups: np.ndarray  # (P,) uint32: of the instances
    area: float

    def __len__(self) -> int:
        return len(self.positions)

    def only(self, kept: np.ndarray) -> "PointCloud":
        """The points where `kept` (P,) is true."""
        names = "positions", "normals", "instances", "triangles", "groups"
        return replace(self, **{name: getattr(self, name)[kept] for name in names})


def similarity(linear: np.ndarray) -> np.ndarray:
    """(I,) scales of linear maps (I,3,3) that are similarity transforms; 0 for others."""
    gram = np.einsum("nki,nkj->nij", linear, linear)
    square = np.trace(gram, axis1=1, axis2=2) / 3.0
    stretched = np.abs(gram - square[:, None, None] * np.eye(3)).max((1, 2)) > 1e-5 * square
    return np.where(stretched, 0.0, np.sqrt(square))


def make_point_cloud(
    scene: Scene, anchor: np.ndarray, count: int, check_cancelled: Callable[[], None] = lambda: None
) -> PointCloud:
    """Points on all instances that cast shadows, in proportion to their world area.

    `check_cancelled` is called between batches. An instance's points are the first ones of its mesh's infinite
    sequence, so they keep their positions on it when it or another instance moves.
    """
    instances = scene.instances
    rows = np.flatnonzero(instances.casts_shadow)
    matrices = instances.world_from_object[rows]
    scales = similarity(matrices[:, :3, :3])
    corners = {k: object_corners(scene.meshes[k]) for k in np.unique(instances.mesh[rows])}
    mesh_areas = {k: triangle_areas(c).sum() for k, c in corners.items()}
    areas = np.array([mesh_areas[k] for k in instances.mesh[rows]]) * scales**2
    for i in np.flatnonzero(scales == 0.0):
        areas[i] = triangle_areas(corners[instances.mesh[rows[i]]] @ matrices[i, :3, :3].T).sum()
    total = areas.sum()
    if total <= 0.0:
        vectors, indices = np.zeros((0, 3), np.float32), np.zeros(0, np.int64)
        return PointCloud(vectors, vectors, indices, indices, np.zeros(0, np.uint32), 0.0)
    counts = proportional_counts(areas, count)
    points = Points(np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count, np.int64))
    ends = np.cumsum(counts)
    for k, mesh_corners in corners.items():
        of_mesh = instances.mesh[rows] == k
        for group in [np.flatnonzero(of_mesh & (scales > 0.0)), *np.flatnonzero(of_mesh & (scales == 0.0))[:, None]]:
            fill(points, mesh_corners, matrices[group], counts[group], ends[group], check_cancelled)
    positions, normals = (points.positions - anchor).astype(np.float32), points.normals.astype(np.float32)
    of_instance = np.repeat(rows, counts)
    groups = instances.groups[of_instance]
    return PointCloud(positions, normals, of_instance, points.triangles, groups, float(total) / count)


class Points(NamedTuple):
    """Points of all instances, to be filled."""

    positions: np.ndarray  # (P,3) m, world space
    normals: np.ndarray  # (P,3)
    triangles: np.ndarray  # (P,) int: of the mesh


def fill(
    points: Points,
    corners: np.ndarray,
    matrices: np.ndarray,
    counts: np.ndarray,
    ends: np.ndarray,
    check_cancelled: Callable[[], None],
) -> None:
    """Write the first `counts` (I,) points of a mesh with `corners` (T,3,3) for each instance, before `ends` (I,)."""
    if not counts.sum():
        return
    linear = matrices[:, :3, :3]
    # Similarity transforms keep the ratios of areas, so such instances share one sequence. Each other one has its own.
    scaled = corners if len(matrices) > 1 or similarity(linear)[0] > 0.0 else corners @ linear[0].T
    chosen, on_mesh = points_on_triangles(scaled, int(counts.max()))
    if scaled is not corners:
        linear = np.eye(3)[None]
    face_normals = np.cross(scaled[:, 1] - scaled[:, 0], scaled[:, 2] - scaled[:, 0])[chosen]
    face_normals /= np.maximum(np.linalg.norm(face_normals, axis=1, keepdims=True), 1e-300)
    all_rows = np.repeat(np.arange(len(counts)), counts)
    all_index = np.arange(len(all_rows)) - np.repeat(np.cumsum(counts) - counts, counts)
    for first in range(0, len(all_rows), POINTS_AT_A_TIME):
        check_cancelled()
        row, index = (numbers[first : first + POINTS_AT_A_TIME] for numbers in (all_rows, all_index))
        target = (ends - counts)[row] + index
        points.triangles[target] = chosen[index]
        points.positions[target] = np.einsum("nij,nj->ni", linear[row], on_mesh[index]) + matrices[row, :3, 3]
        rotated = np.einsum("nij,nj->ni", linear[row], face_normals[index])
        points.normals[target] = rotated / np.maximum(np.linalg.norm(rotated, axis=1, keepdims=True), 1e-300)


def object_corners(mesh: Mesh) -> np.ndarray:
    """(T,3,3) float64 object space."""
    return mesh.positions.astype(np.float64)[mesh.triangles]
