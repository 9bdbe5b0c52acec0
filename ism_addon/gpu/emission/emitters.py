# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes lights of emissive meshes: one of each connected part of an instance, with a light BVH if it is large.

Materials emit light from both sides, unless their graphs tell otherwise. The inner side of a closed part is hidden from
outside of it, so its triangles count as one-sided there: otherwise half of the light would be unshadowed light that its
other half occludes.
"""

import numpy as np

from ...color import luminance
from ...scene import Instances, Lights, Mesh, Scene
from ...scene.arrays import array_specs
from .baked_emission import BakedEmission, key_of, lighting_instances
from .emissive_lights import EmissiveLights
from .light_bvh import median_leaves, normal_areas
from .light_tables import Emitters, lights_of_emitters
from .mesh_parts import parts_of
from .pieces import Pieces

#: If there are more lights than this, neighbours of the same emission are joined until no emission has more.
MAX_LIGHTS = 256


class EmissiveMeshes:
    """Adds the lights of emissive meshes to a scene's. They are kept until one of these meshes changes."""

    def __init__(self) -> None:
        self.key: tuple[object, ...] = ()
        self.own: EmissiveLights | None = None  # without lamps
        #: Lamps, and the same with `own`.
        self.joined: tuple[Lights, Lights] | None = None

    def lights_of(self, scene: Scene, baked: BakedEmission | None = None) -> Lights:
        """The lights of a scene, and after them those of its emissive meshes, if there are any.

        Without the scene's own `baked` emission, meshes with graphs of it emit evenly.
        """
        baked = baked if baked is not None and baked.key == key_of(scene) else None
        rows, instances, materials = emissive_instances(scene), scene.instances, scene.materials
        arrays = [getattr(instances, name) for name in array_specs(Instances)][1:]
        tables = (array[rows].tobytes() for array in arrays if len(array))
        key = (*(scene.meshes[k] for k in instances.mesh[rows]), materials.emission.tobytes(), *tables)
        key = *key, scene.working_space, materials.emission_graph.tobytes(), baked
        if key != self.key:
            self.key, self.own, self.joined = key, emissive_lights(scene, rows, baked), None
        if self.own is None:
            return scene.lights
        if self.joined is None or self.joined[0] is not scene.lights:
            self.joined = scene.lights, after_lamps(scene.lights, self.own)
        return self.joined[1]


def emits(scene: Scene) -> np.ndarray:
    """(M,) bool: which materials emit."""
    emissive: np.ndarray = scene.materials.emission.any(1)
    return emissive | (scene.materials.emission_graph >= 0) if scene.has_emission_graphs else emissive


def emissive_instances(scene: Scene) -> np.ndarray:
    """(K,) int: instances that light surfaces, if any of their triangles emits."""
    return lighting_instances(scene, emits(scene))


def emissive_lights(scene: Scene, rows: np.ndarray, baked: BakedEmission | None) -> EmissiveLights | None:
    """The lights of the emissive instances (K,) of a scene; None if there are none."""
    mesh, group_of, found = scene.instances.mesh[rows], emission_groups(scene), []
    pieces = {} if baked is None else baked.pieces
    alike = np.array([id(pieces.get(row)) for row in rows.tolist()], int)
    for k, pieces_id in np.unique(np.stack([mesh, alike], 1), axis=0).tolist() if len(rows) else ():
        members = rows[(mesh == k) & (alike == pieces_id)]
        own = emissive_pieces(scene, scene.meshes[k], None if baked is None else pieces.get(int(members[0])))
        if len(own.triangle):
            found.append(emitters_of(scene, scene.meshes[k], own, members, group_of))
    emitters = with_area(concatenated(found)) if found else None
    if emitters is None or not len(emitters.group):
        return None
    return lights_of_emitters(joined(emitters), luminance(scene.working_space))


def emission_groups(scene: Scene) -> np.ndarray:
    """(M,) int: equal for materials whose lights may be joined, as their emission is equal."""
    keys = np.pad(scene.materials.emission.astype(np.float64), ((0, 0), (0, 1)))
    if scene.has_emission_graphs:
        keys[:, 3] = np.where(scene.materials.emission_graph >= 0, 1 + np.arange(len(keys)), 0)
    groups: np.ndarray = np.unique(keys, axis=0, return_inverse=True)[1].ravel()
    return groups


def emissive_pieces(scene: Scene, mesh: Mesh, baked: Pieces | None) -> Pieces:
    """What of a mesh emits; `baked`: of the materials with graphs, if that is known."""
    chosen = emits(scene)
    if baked is not None:
        chosen &= scene.materials.emission_graph < 0
    triangle = np.flatnonzero(chosen[mesh.materials])
    even = Pieces(triangle, scene.materials.emission[mesh.materials[triangle]])
    return even if baked is None else Pieces.joined([even, baked])


def emitters_of(scene: Scene, mesh: Mesh, pieces: Pieces, instances: np.ndarray, group_of: np.ndarray) -> Emitters:
    """The emitters of pieces of a mesh in these instances. `group_of` (M,): see emission_groups."""
    parts, chosen = parts_of(mesh), pieces.triangle
    pairs = parts.part[chosen] * len(group_of) + group_of[mesh.materials[chosen]]
    _, example, own = np.unique(pairs, return_index=True, return_inverse=True)
    part, count = parts.part[chosen[example]], len(instances)
    matrices = scene.instances.world_from_object[instances]
    linear, offset = matrices[:, :3, :3], matrices[:, :3, 3]
    vertices = mesh.positions[mesh.triangles[chosen]].astype(np.float64)
    if pieces.corners is not None:
        vertices = np.einsum("tab,tbj->taj", pieces.corners, vertices)
    corners = np.einsum("kij,tcj->ktci", linear, vertices) + offset[:, None, None]
    hidden = hides_its_back(scene.instances, instances)
    side = parts.side[part][own] * hidden[:, None]
    is_sided = np.zeros(len(part), bool)
    if pieces.side is not None:
        side = np.where(pieces.side != 0, pieces.side, side)
        is_sided[own] = pieces.side != 0
    side = side * np.sign(np.linalg.det(linear))[:, None]
    is_clockwise = side < 0.0
    corners[is_clockwise] = corners[is_clockwise][:, ::-1]
    middle, half = parts.boxes[part].sum(1) / 2.0, (parts.boxes[part, 1] - parts.boxes[part, 0]) / 2.0
    middle = np.einsum("kij,pj->kpi", linear, middle) + offset[:, None]
    half = np.einsum("kij,pj->kpi", np.abs(linear), half) * np.where(is_sided, -1.0, 1.0)[:, None]  # nothing is inside
    enclosure = np.stack([middle - half, middle + half], 2)
    links = np.stack([scene.instances.receivers[instances], scene.instances.blockers[instances]], 1)
    return Emitters(
        corners.reshape(-1, 3, 3),
        (side != 0.0).ravel(),
        np.tile(pieces.radiance, (count, 1)),
        (own + len(part) * np.arange(count)[:, None]).ravel(),
        np.tile(group_of[mesh.materials[chosen[example]]], count),
        links.repeat(len(part), 0),
        enclosure.reshape(-1, 2, 3),
    )


def hides_its_back(instances: Instances, chosen: np.ndarray) -> np.ndarray:
    """(K,) bool: which of the chosen instances cast shadows of their own light."""
    group = instances.blockers[chosen]
    linked = instances.groups[chosen] >> np.maximum(group, 0).astype(np.uint32) & 1 == 1
    return instances.casts_shadow[chosen] & ((group < 0) | linked)


def concatenated(all_emitters: list[Emitters]) -> Emitters:
    """Emitters as one, with their lights one after the other."""
    counts = [len(each.group) for each in all_emitters]
    shifted = [
        each._replace(light=each.light + first)
        for each, first in zip(all_emitters, np.cumsum([0, *counts[:-1]]), strict=True)
    ]
    return Emitters(*(np.concatenate(columns) for columns in zip(*shifted, strict=True)))


def with_area(emitters: Emitters) -> Emitters:
    """Without triangles that have no area, and lights that have no others."""
    has_area = np.linalg.norm(normal_areas(emitters.corners), axis=1).astype(np.float32) > 0.0
    if has_area.all():
        return emitters
    lights, light = np.unique(emitters.light[has_area], return_inverse=True)
    return Emitters(
        emitters.corners[has_area],
        emitters.one_sided[has_area],
        emitters.radiance[has_area],
        light.ravel(),
        *(column[lights] for column in (emitters.group, emitters.links, emitters.enclosure)),
    )


def joined(emitters: Emitters) -> Emitters:
    """At most MAX_LIGHTS lights for each group and links: neighbours are joined."""
    if len(emitters.group) <= MAX_LIGHTS:
        return emitters
    keys, centres = np.concatenate([emitters.group[:, None], emitters.links], 1), emitters.enclosure.mean(1)
    kind, light, count = np.unique(keys, axis=0, return_inverse=True)[1].ravel(), np.empty(len(keys), int), 0
    for each in range(kind.max() + 1):
        members = np.flatnonzero(kind == each)
        leaves = median_leaves(centres[members], -(-len(members) // MAX_LIGHTS))
        for leaf in leaves:
            light[members[leaf[leaf < len(members)]]] = count
            count += int((leaf < len(members)).any())
    order = np.argsort(light, kind="stable")
    first = np.searchsorted(light[order], np.arange(count))
    low, high = np.moveaxis(emitters.enclosure[order], 1, 0)
    low, high = np.minimum.reduceat(low, first), np.maximum.reduceat(high, first)
    return emitters._replace(
        light=light[emitters.light],
        group=emitters.group[order[first]],
        links=emitters.links[order[first]],
        enclosure=np.stack([low, high], 1),
    )


def after_lamps(lamps: Lights, own: EmissiveLights) -> EmissiveLights:
    """A table of lamps, and after them the lights of emissive triangles."""
    values = {}
    for name, spec in array_specs(EmissiveLights).items():
        rows = getattr(own, name)
        if spec.shapes[0][0] == "L":
            first = getattr(lamps, name, np.zeros((len(lamps.shape), *rows.shape[1:]), rows.dtype))
            rows = np.concatenate([first, rows])
        values[name] = rows
    return EmissiveLights.of(**values)
