# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals of meshes with sharp edges, as Cycles has them before Blender 5.2.

It splits the vertices along sharp edges, and gives each vertex then the normal of its last corner. Blender's own
normals of corners differ where a smooth edge has more than two faces, or two that face opposite ways, and where faces
touch only at a vertex: it counts those as sharp, but Cycles does not split them.
"""

import bpy
import numpy as np

from . import triangulate


def split_normals(source: bpy.types.Mesh, normals: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """The normals (C,3) of corners at `vertices` (C,), each the one that the last corner of its split vertex has."""
    corners, edges = len(vertices), len(source.edges)
    ends = triangulate.read(source.attributes[".edge_verts"].data, "value", (edges, 2), np.int32)
    edge = triangulate.read(source.attributes[".corner_edge"].data, "value", corners, np.int32)
    starts = triangulate.read(source.polygons, "loop_start", len(source.polygons), np.int32)
    sizes = np.diff(starts, append=corners)
    split = _split_edges(source, edge, sizes)
    faces = np.bincount(edge, minlength=edges)
    forward = np.bincount(edge[ends[edge, 0] == vertices], minlength=edges)
    is_regular = (faces < 2) | ((faces == 2) & (forward == 1))
    count = len(source.vertices)
    surplus = np.bincount(ends[faces > 0].ravel(), minlength=count) - np.bincount(vertices, minlength=count)
    is_irregular = surplus > 1  # several fans
    is_irregular[ends[~split & ~is_regular]] = True
    chosen = np.flatnonzero(is_irregular[vertices])
    if not len(chosen):
        return normals
    # Corners of a vertex are joined across edges that are not split; all of a vertex that has no split edge.
    is_split = np.zeros(count, np.bool_)
    is_split[ends[split]] = True
    previous = np.arange(-1, corners - 1)
    previous[starts] = starts + sizes - 1
    around = np.concatenate([edge[chosen], edge[previous[chosen]]])
    corner, vertex = np.tile(chosen, 2), np.tile(vertices[chosen], 2)
    joins = ~split[around] | ~is_split[vertex]
    around = np.where(is_split[vertex], around, edges)
    _, group = np.unique((vertex.astype(np.int64) * (edges + 1) + around)[joins], return_inverse=True)
    return normals[_last_of_joined(corners, corner[joins], group)]


def _split_edges(source: bpy.types.Mesh, edge: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """(E,) bool: sharp edges, and those of flat faces."""
    split = np.zeros(len(source.edges), np.bool_)
    if (sharp := source.attributes.get("sharp_edge")) is not None:
        split = triangulate.read(sharp.data, "value", len(split), np.bool_)
    if (flat := source.attributes.get("sharp_face")) is not None:
        split[edge[triangulate.read(flat.data, "value", len(sizes), np.bool_).repeat(sizes)]] = True
    return split


def _last_of_joined(count: int, corner: np.ndarray, group: np.ndarray) -> np.ndarray:
    """(C,): of each of `count` corners, the last that groups join it with. `corner` and `group` (N,): their members."""
    last, before = np.arange(count), None
    while before is None or (last != before).any():
        before = last.copy()
        last_of_group = np.zeros(group.max(initial=0) + 1, last.dtype)
        np.maximum.at(last_of_group, group, last[corner])
        np.maximum.at(last, corner, last_of_group[group])
    return last
