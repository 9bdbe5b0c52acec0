# SPDX-License-Identifier: GPL-3.0-or-later
"""What meshes emit whose materials have a graph of their radiance: where it is evaluated, and the result."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...scene import Instances, Mesh, Scene
from ...scene.arrays import array_specs
from .light_bvh import normal_areas
from .mesh_parts import parts_of
from .pieces import MAX_DIFFERENCE, PARTS, Pieces, depth_within, split

#: The most pieces that the triangles of a light are split to, and the most points at which they are evaluated; and
#: those of a scene, which its lights share.
LIGHT_PIECES, LIGHT_POINTS = 1 << 10, 1 << 16
SCENE_PIECES, SCENE_POINTS = 1 << 16, 1 << 21


@dataclass(frozen=True, eq=False)
class BakedEmission:
    """The emission of a scene's instances that have graphs of it."""

    key: tuple[object, ...]  # see key_of
    view: object  # state of the view, if graphs read it
    pieces: Mapping[int, Pieces]  # by instance; the same object for equal ones


class Bake(NamedTuple):
    """Triangles of a mesh that are evaluated equally often, in some of its instances."""

    mesh: int
    instances: np.ndarray  # (K,) int
    triangles: np.ndarray  # (N,) int
    light: np.ndarray  # (N,) int: the light of an instance that each is of
    depth: int  # of the parts with a point each
    max_pieces: int  # of a light
    sides: int  # 2: the back is evaluated too

    @property
    def points(self) -> int:
        """Number of points in one instance."""
        return self.sides * len(self.triangles) * PARTS**self.depth

    def pieces(self, mesh: Mesh, radiance: np.ndarray) -> list[Pieces]:
        """Pieces in each instance, of the radiance (K * points,3): the same object for all if all are equal."""
        values = radiance.reshape(len(self.instances), self.sides, len(self.triangles), -1, 3).astype(np.float64)
        areas = np.linalg.norm(normal_areas(mesh.positions[mesh.triangles[self.triangles]].astype(np.float64)), axis=1)
        light = np.unique(self.light, return_inverse=True)[1].ravel()

        def pieces_of(front: np.ndarray, *back: np.ndarray) -> Pieces:
            on_front = split(self.triangles, light, areas, front, self.max_pieces)
            if not back or np.abs(front - back[0]).max() <= MAX_DIFFERENCE * max(front.max(), back[0].max()):
                return on_front
            on_back = split(self.triangles, light, areas, back[0], self.max_pieces)
            return Pieces.joined([on_front.on_side(1), on_back.on_side(-1)])

        if (values == values[:1]).all():
            return [pieces_of(*values[0])] * len(values)
        return [pieces_of(*each) for each in values]


def lighting_instances(scene: Scene, chosen: np.ndarray) -> np.ndarray:
    """(K,) int: instances that light surfaces, if any of their triangles has a material of `chosen` (M,) bool."""
    if not chosen.any():
        return np.zeros(0, int)
    has_chosen = np.array([chosen[mesh.material_indices].any() for mesh in scene.meshes], bool)
    return np.flatnonzero(has_chosen[scene.instances.mesh] & scene.instances.visible_diffuse)


def instances_with_graphs(scene: Scene) -> np.ndarray:
    """(K,) int: instances that light surfaces, if the emission of any of their triangles is a graph."""
    return lighting_instances(scene, scene.materials.emission_graph >= 0)


def key_of(scene: Scene) -> tuple[object, ...]:
    """What the emission of a scene's instances depends on."""
    rows, instances, materials = instances_with_graphs(scene), scene.instances, scene.materials
    arrays = [getattr(instances, name) for name in array_specs(Instances)][1:]
    tables = (array[rows].tobytes() for array in arrays if len(array))
    graphs = [scene.graphs[k] if k >= 0 else None for k in materials.emission_graph.tolist()]
    firsts = materials.emission_constant.tolist()
    constants = (
        materials.constants[first : first + graph.rows].tobytes()
        for graph, first in zip(graphs, firsts, strict=True)
        if graph is not None
    )
    images = scene.images if any(graph.uses("image") for graph in graphs if graph is not None) else ()
    return (*rows.tolist(), *(scene.meshes[k] for k in instances.mesh[rows]), *tables, *graphs, *constants, *images)


def bakes_of(scene: Scene) -> list[Bake]:
    """All that is to be evaluated in a scene."""
    rows = instances_with_graphs(scene)
    mesh, has_graph, lights = scene.instances.mesh[rows], scene.materials.emission_graph >= 0, 0
    triangles, light_of = dict[int, np.ndarray](), dict[int, np.ndarray]()
    for k in np.unique(mesh).tolist():
        materials = scene.meshes[k].materials
        chosen = triangles[k] = np.flatnonzero(has_graph[materials])
        pairs = parts_of(scene.meshes[k]).part[chosen] * len(has_graph) + materials[chosen]
        _, own = np.unique(pairs, return_inverse=True)
        light_of[k] = own.ravel()
        lights += (int(light_of[k].max()) + 1) * int((mesh == k).sum())
    max_pieces, max_points = LIGHT_PIECES, LIGHT_POINTS
    if lights:
        max_pieces, max_points = min(max_pieces, SCENE_PIECES // lights), min(max_points, SCENE_POINTS // lights)
    bakes = []
    for k, light in light_of.items():
        depths = np.array([depth_within(count, max_points) for count in np.bincount(light).tolist()])
        for depth in np.unique(depths).tolist():
            own = (depths == depth)[light]
            graphs = np.unique(scene.materials.emission_graph[scene.meshes[k].materials[triangles[k][own]]])
            sides = 1 + any(scene.graphs[graph].reads_side for graph in graphs.tolist())
            bakes.append(Bake(k, rows[mesh == k], triangles[k][own], light[own], depth, max_pieces, sides))
    return bakes
