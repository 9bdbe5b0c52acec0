# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes lights of emissive meshes: one of each connected part of an instance, with a light BVH if it is large.

Materials emit light from both sides. The inner side of a closed part is hidden from outside of it, so its triangles
count as one-sided there: otherwise half of the light would be unshadowed light that its other half occludes.
"""

from collections import Counter
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ...scene import Instances, Lights, Mesh, Scene
from ...scene.arrays import array_specs
from .emissive_lights import EMISSIVE_MESH, MAX_EXACT_TRIANGLES, EmissiveLights
from .light_bvh import MIN_DIVISOR, LightBVH, median_leaves, normal_areas, triangle_boxes
from .mesh_parts import parts_of

#: If there are more lights than this, neighbours of the same emission are joined until no emission has more.
MAX_LIGHTS = 256

#: Emissive triangles have the same shape if their corners agree to this fraction of their size.
SHAPE_STEPS = 1 << 20


class Emitters(NamedTuple):
    """Emissive triangles (T,) and the lights (L,) that they belong to."""

    corners: np.ndarray  # (T,3,3) m, counterclockwise as seen from outside if one-sided
    one_sided: np.ndarray  # (T,) bool
    light: np.ndarray  # (T,) int
    emission: np.ndarray  # (L,3)
    links: np.ndarray  # (L,2) int: groups of receivers and blockers
    enclosure: np.ndarray  # (L,2,3) m


class EmissiveMeshes:
    """Adds the lights of emissive meshes to a scene's. They are kept until one of these meshes changes."""

    def __init__(self) -> None:
        self.key: tuple[object, ...] = ()
        self.own: EmissiveLights | None = None  # without lamps
        #: Lamps, and the same with `own`.
        self.joined: tuple[Lights, Lights] | None = None

    def lights_of(self, scene: Scene) -> Lights:
        """The lights of a scene, and after them those of its emissive meshes, if there are any."""
        rows, instances, materials = emissive_instances(scene), scene.instances, scene.materials
        arrays = [getattr(instances, name) for name in array_specs(Instances)][1:]
        tables = (array[rows].tobytes() for array in arrays if len(array))
        key = (*(scene.meshes[k] for k in instances.mesh[rows]), materials.emission.tobytes(), *tables)
        if key != self.key:
            self.key, self.own, self.joined = key, emissive_lights(scene, rows), None
        if self.own is None:
            return scene.lights
        if self.joined is None or self.joined[0] is not scene.lights:
            self.joined = scene.lights, after_lamps(scene.lights, self.own)
        return self.joined[1]


def emissive_instances(scene: Scene) -> np.ndarray:
    """(K,) int: instances that light surfaces, if any of their triangles emits."""
    emits = scene.materials.emission.any(1)
    if not emits.any():
        return np.zeros(0, int)
    mesh_emits = np.array([emits[mesh.material_indices].any() for mesh in scene.meshes], bool)
    return np.flatnonzero(mesh_emits[scene.instances.mesh] & scene.instances.visible_diffuse)


def emissive_lights(scene: Scene, rows: np.ndarray) -> EmissiveLights | None:
    """The lights of the emissive instances (K,) of a scene; None if there are none."""
    emits, mesh = scene.materials.emission.any(1), scene.instances.mesh[rows]
    _, emission_of = np.unique(scene.materials.emission, axis=0, return_inverse=True)
    found = []
    for k in np.unique(mesh):
        chosen = np.flatnonzero(emits[scene.meshes[k].materials])
        found.append(emitters_of(scene, scene.meshes[k], chosen, rows[mesh == k], emission_of.ravel()))
    emitters = with_area(concatenated(found)) if found else None
    return None if emitters is None or not len(emitters.light) else lights_of_emitters(joined(emitters))


def emitters_of(
    scene: Scene, mesh: Mesh, chosen: np.ndarray, instances: np.ndarray, emission_of: np.ndarray
) -> Emitters:
    """The emitters of the chosen triangles of a mesh in these instances. `emission_of` (M,): equal for equal ones."""
    parts, materials = parts_of(mesh), mesh.materials[chosen]
    pairs = parts.part[chosen] * len(emission_of) + emission_of[materials]
    _, example, own = np.unique(pairs, return_index=True, return_inverse=True)
    part, count = parts.part[chosen[example]], len(instances)
    matrices = scene.instances.world_from_object[instances]
    linear, offset = matrices[:, :3, :3], matrices[:, :3, 3]
    vertices = mesh.positions[mesh.triangles[chosen]].astype(np.float64)
    corners = np.einsum("kij,tcj->ktci", linear, vertices) + offset[:, None, None]
    hidden = hides_its_back(scene.instances, instances)
    side = parts.side[part][own] * (np.sign(np.linalg.det(linear)) * hidden)[:, None]
    is_clockwise = side < 0.0
    corners[is_clockwise] = corners[is_clockwise][:, ::-1]
    middle, half = parts.boxes[part].sum(1) / 2.0, (parts.boxes[part, 1] - parts.boxes[part, 0]) / 2.0
    middle = np.einsum("kij,pj->kpi", linear, middle) + offset[:, None]
    half = np.einsum("kij,pj->kpi", np.abs(linear), half)
    enclosure = np.stack([middle - half, middle + half], 2)
    links = np.stack([scene.instances.receivers[instances], scene.instances.blockers[instances]], 1)
    return Emitters(
        corners.reshape(-1, 3, 3),
        (side != 0.0).ravel(),
        (own + len(part) * np.arange(count)[:, None]).ravel(),
        np.tile(scene.materials.emission[materials[example]], (count, 1)),
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
    counts = [len(each.emission) for each in all_emitters]
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
        light.ravel(),
        *(column[lights] for column in (emitters.emission, emitters.links, emitters.enclosure)),
    )


def joined(emitters: Emitters) -> Emitters:
    """At most MAX_LIGHTS lights for each emission and links: neighbours are joined."""
    if len(emitters.emission) <= MAX_LIGHTS:
        return emitters
    keys, centres = np.concatenate([emitters.emission, emitters.links], 1), emitters.enclosure.mean(1)
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
        emission=emitters.emission[order[first]],
        links=emitters.links[order[first]],
        enclosure=np.stack([low, high], 1),
    )


def lights_of_emitters(emitters: Emitters) -> EmissiveLights:
    """A table of the lights of emissive triangles."""
    count, order = len(emitters.emission), np.argsort(emitters.light, kind="stable")
    bounds = np.searchsorted(emitters.light[order], np.arange(count + 1))
    lights_by_size, shapes = Counter(np.diff(bounds).tolist()), dict[bytes, tuple[LightBVH, np.ndarray]]()
    triangles, bvhs = [], []
    for first, end in pairwise(bounds):
        corners, bvh = emitters.corners[order[first:end]], None
        if end - first > MAX_EXACT_TRIANGLES:
            bvh = shared_bvh(corners, shapes) if lights_by_size[end - first] > 1 else LightBVH.over(corners)
        rows = np.append(order[first:end], -1)
        triangles.append(rows[:-1] if bvh is None else rows[bvh.triangles])
        bvhs.append(bvh)
    one_sided = np.bincount(emitters.light, ~emitters.one_sided, count) == 0
    of_lights = emissive_rows(emitters, triangles, bvhs)
    return EmissiveLights.of(**of_lights, **triangle_tables(emitters, triangles), **node_tables(one_sided, bvhs))


def shared_bvh(corners: np.ndarray, shapes: dict[bytes, tuple[LightBVH, np.ndarray]]) -> LightBVH:
    """The light BVH over triangles (N,3,3). Copies that are only moved share one: `shapes`, with the middle of each."""
    middle = corners.mean((0, 1))
    local = corners - middle
    size = float(f"{np.abs(local).max():.6e}")  # so rounded that copies have the same
    shape = (
        np.rint(local * (SHAPE_STEPS / max(size, float(MIN_DIVISOR)))).astype(np.int32).tobytes() + str(size).encode()
    )
    if shape not in shapes:
        shapes[shape] = LightBVH.over(corners), middle
    bvh, first_middle = shapes[shape]
    return replace(bvh, centre=bvh.centre + (middle - first_middle))


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


def emissive_rows(
    emitters: Emitters, triangles: list[np.ndarray], bvhs: list[LightBVH | None]
) -> dict[str, np.ndarray]:
    """Fields of the lights, by name; `triangles`: rows of the emitters by light, -1 to fill up leaves."""
    count, light = len(emitters.emission), emitters.light
    order = np.argsort(light, kind="stable")
    starts = np.searchsorted(light[order], np.arange(count))
    low, high = triangle_boxes(emitters.corners)
    low, high = np.minimum.reduceat(low[order], starts), np.maximum.reduceat(high[order], starts)
    sizes, leaves = np.array([len(each) for each in triangles]), np.array([bvh.leaves if bvh else 0 for bvh in bvhs])
    unit = np.tile(np.eye(3)[:, None], (1, count, 1))
    return {
        "shape": np.full(count, EMISSIVE_MESH),
        "position": (low + high) / 2.0,
        "axis_u": unit[0],
        "axis_v": unit[1],
        "normal": unit[2],
        "emission": emitters.emission,
        "spread": np.full(count, np.pi),
        "blend": np.zeros(count),
        "radius": np.linalg.norm(high - low, axis=1) / 2.0,
        "soft_falloff": np.zeros(count, bool),
        "falloff_power": np.zeros(count, np.int32),
        "falloff_smooth": np.zeros(count),
        "profile": np.full(count, -1),
        "profile_axes": np.zeros((count, 3, 3)),
        "image": np.full(count, -1),
        "casts_shadow": np.ones(count, bool),
        "visible_camera": np.zeros(count, bool),
        "shadow_softness": np.ones(count),
        "receivers": emitters.links[:, 0],
        "blockers": emitters.links[:, 1],
        "first_triangle": np.cumsum(sizes) - sizes,
        "triangle_count": sizes,
        "first_node": 2 * (np.cumsum(leaves) - leaves),
        "leaves": leaves,
        "projected_area": projected_areas(normal_areas(emitters.corners), emitters.one_sided, light, count),
        "enclosure": emitters.enclosure,
    }


def projected_areas(normals: np.ndarray, one_sided: np.ndarray, light: np.ndarray, count: int) -> np.ndarray:
    """(L,) m²: upper bounds of the lights' areas as seen from any direction w, from normals times areas (T,3).

    The sum of areas times |n . w| is at most that times its root mean square. Of one-sided triangles half of it counts,
    and half of the sum of n . w.
    """
    areas = np.linalg.norm(normals, axis=1)
    total = np.bincount(light, areas, count)
    outer = np.einsum("ti,tj->tij", normals, normals / np.maximum(areas, 1e-300)[:, None]).reshape(-1, 9)
    squares = np.stack([np.bincount(light, column, count) for column in outer.T], 1).reshape(-1, 3, 3)
    both = np.sqrt(total * np.linalg.eigvalsh(squares)[:, -1])
    mean = np.linalg.norm([np.bincount(light, column, count) for column in normals.T], axis=0)
    is_one_sided = np.bincount(light, ~one_sided, count) == 0
    return np.minimum(total, np.where(is_one_sided, (both + mean) / 2.0, both))


def triangle_tables(emitters: Emitters, triangles: list[np.ndarray]) -> dict[str, np.ndarray]:
    """Fields of the triangles, by name."""
    rows = np.concatenate(triangles)
    corners = np.where((rows < 0)[:, None, None], 0.0, emitters.corners[rows])
    return {"corners": corners, "one_sided": emitters.one_sided[rows]}


def node_tables(one_sided: np.ndarray, bvhs: list[LightBVH | None]) -> dict[str, np.ndarray]:
    """Fields of the nodes, by name; `one_sided` (L,): whether all triangles of a light are."""
    tables = {
        name: np.concatenate(
            [spec.empty(), *(getattr(bvh, name.removeprefix("node_")) for bvh in bvhs if bvh is not None)]
        )
        for name, spec in array_specs(EmissiveLights).items()
        if spec.shapes[0][0] == "N" and name != "node_one_sided"
    }
    nodes = [2 * bvh.leaves if bvh is not None else 0 for bvh in bvhs]
    return tables | {"node_one_sided": np.repeat(one_sided, nodes)}
