# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of lights of emissive triangles."""

from collections import Counter
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ...scene.arrays import array_specs
from .emissive_lights import EMISSIVE_MESH, MAX_EXACT_TRIANGLES, EmissiveLights
from .light_bvh import MIN_DIVISOR, LightBVH, normal_areas, triangle_boxes
from .pieces import MAX_DIFFERENCE

#: Emissive triangles have the same shape if their corners agree to this fraction of their size.
SHAPE_STEPS = 1 << 20

#: Of fields of EmissiveLights that LightBVH has without it.
PREFIX = "node_"


class Emitters(NamedTuple):
    """Emissive triangles (T,) and the lights (L,) that they belong to."""

    corners: np.ndarray  # (T,3,3) m, counterclockwise as seen from outside if one-sided
    one_sided: np.ndarray  # (T,) bool
    radiance: np.ndarray  # (T,3) W/(sr m²)
    light: np.ndarray  # (T,) int
    group: np.ndarray  # (L,) int: equal if the lights may be joined
    links: np.ndarray  # (L,2) int: groups of receivers and blockers
    enclosure: np.ndarray  # (L,2,3) m


class Brightness(NamedTuple):
    """The emission of lights (L,), and what of their triangles (T,) differs from it."""

    emission: np.ndarray  # (L,3) W/(sr m²): the mean over the area
    varies: np.ndarray  # (L,) bool: whether triangles have not about that
    colors: np.ndarray | None  # (T,4): see EmissiveLights; None if no light varies

    @property
    def factors(self) -> np.ndarray | float:
        """(T,) relative luminances."""
        return 1.0 if self.colors is None else self.colors[:, 3]


def brightness_of(emitters: Emitters, weights: np.ndarray) -> Brightness:
    """The brightness of emitters. `weights` (3,): luminances of the primaries."""
    light, order = emitters.light, np.argsort(emitters.light, kind="stable")
    count, starts = len(emitters.group), np.searchsorted(light[order], np.arange(len(emitters.group)))
    ordered = emitters.radiance[order]
    low, high = np.minimum.reduceat(ordered, starts), np.maximum.reduceat(ordered, starts)
    emission, differs = low.astype(np.float64), (high != low).any(1)
    varies = differs & (high - low > MAX_DIFFERENCE * high.max(1, keepdims=True)).any(1)
    if not differs.any():
        return Brightness(emission, varies, None)
    areas, colors = np.linalg.norm(normal_areas(emitters.corners), axis=1), np.ones((len(light), 4))
    sums = [np.bincount(light, areas * column, count) for column in emitters.radiance.T]
    emission[differs] = (np.stack(sums, 1) / np.bincount(light, areas, count)[:, None])[differs]
    rows = np.flatnonzero(varies[light])
    mean = emission[light[rows]]
    relative = np.divide(emitters.radiance[rows], mean, out=np.zeros_like(mean), where=mean > 0.0)
    luminance = (emitters.radiance[rows] @ weights) / (mean @ weights)
    relative = np.divide(relative, luminance[:, None], out=np.zeros_like(relative), where=luminance[:, None] > 0.0)
    colors[rows] = np.concatenate([relative, luminance[:, None]], 1)
    return Brightness(emission, varies, colors if varies.any() else None)


def lights_of_emitters(emitters: Emitters, weights: np.ndarray) -> EmissiveLights:
    """A table of the lights of emissive triangles. `weights` (3,): luminances of the primaries."""
    brightness = brightness_of(emitters, weights)
    count, order = len(emitters.group), np.argsort(emitters.light, kind="stable")
    bounds = np.searchsorted(emitters.light[order], np.arange(count + 1))
    lights_by_size, shapes = Counter(np.diff(bounds).tolist()), dict[bytes, tuple[LightBVH, np.ndarray]]()
    triangles, bvhs = [], []
    for first, end in pairwise(bounds):
        corners, bvh = emitters.corners[order[first:end]], None
        colors = None if brightness.colors is None else brightness.colors[order[first:end]]
        if end - first > MAX_EXACT_TRIANGLES:
            is_common = lights_by_size[end - first] > 1
            bvh = shared_bvh(corners, colors, shapes) if is_common else LightBVH.over(corners, colors)
        rows = np.append(order[first:end], -1)
        triangles.append(rows[:-1] if bvh is None else rows[bvh.triangles])
        bvhs.append(bvh)
    one_sided = np.bincount(emitters.light, ~emitters.one_sided, count) == 0
    of_lights = emissive_rows(emitters, brightness, triangles, bvhs)
    of_triangles = triangle_tables(emitters, brightness, triangles)
    return EmissiveLights.of(**of_lights, **of_triangles, **node_tables(one_sided, bvhs))


def shared_bvh(
    corners: np.ndarray, colors: np.ndarray | None, shapes: dict[bytes, tuple[LightBVH, np.ndarray]]
) -> LightBVH:
    """See LightBVH.over. Copies that are only moved share one: `shapes`, with the middle of each."""
    middle = corners.mean((0, 1))
    local = corners - middle
    size = float(f"{np.abs(local).max():.6e}")  # so rounded that copies have the same
    steps = np.rint(local * (SHAPE_STEPS / max(size, float(MIN_DIVISOR)))).astype(np.int32)
    shape = steps.tobytes() + str(size).encode()
    if colors is not None:
        shape += colors.astype(np.float32).tobytes()
    if shape not in shapes:
        shapes[shape] = LightBVH.over(corners, colors), middle
    bvh, first_middle = shapes[shape]
    return replace(bvh, centre=bvh.centre + (middle - first_middle))


def emissive_rows(
    emitters: Emitters, brightness: Brightness, triangles: list[np.ndarray], bvhs: list[LightBVH | None]
) -> dict[str, np.ndarray]:
    """Fields of the lights, by name; `triangles`: rows of the emitters by light, -1 to fill up leaves."""
    count, light = len(emitters.group), emitters.light
    order = np.argsort(light, kind="stable")
    starts = np.searchsorted(light[order], np.arange(count))
    low, high = triangle_boxes(emitters.corners)
    low, high = np.minimum.reduceat(low[order], starts), np.maximum.reduceat(high[order], starts)
    sizes, leaves = np.array([len(each) for each in triangles]), np.array([bvh.leaves if bvh else 0 for bvh in bvhs])
    factors = np.broadcast_to(brightness.factors, len(light))
    normals = normal_areas(emitters.corners) * factors[:, None]
    unit = np.tile(np.eye(3)[:, None], (1, count, 1))
    return {
        "shape": np.full(count, EMISSIVE_MESH),
        "position": (low + high) / 2.0,
        "axis_u": unit[0],
        "axis_v": unit[1],
        "normal": unit[2],
        "emission": brightness.emission,
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
        "projected_area": projected_areas(normals, emitters.one_sided, light, count),
        "varies": brightness.varies,
        "brightest": np.maximum.reduceat(factors[order], starts),
        "enclosure": emitters.enclosure,
    }


def projected_areas(normals: np.ndarray, one_sided: np.ndarray, light: np.ndarray, count: int) -> np.ndarray:
    """(L,) m²: upper bounds of the lights' areas as seen from any direction w, from normals times areas (T,3), which
    have been multiplied by the relative luminances.

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


def triangle_tables(emitters: Emitters, brightness: Brightness, triangles: list[np.ndarray]) -> dict[str, np.ndarray]:
    """Fields of the triangles, by name; colors only if any light is not even."""
    rows = np.concatenate(triangles)
    corners = np.where((rows < 0)[:, None, None], 0.0, emitters.corners[rows])
    colors = np.zeros((0, 4)) if brightness.colors is None else brightness.colors[rows]
    return {"corners": corners, "one_sided": emitters.one_sided[rows], "colors": colors}


def node_tables(one_sided: np.ndarray, bvhs: list[LightBVH | None]) -> dict[str, np.ndarray]:
    """Fields of the nodes, by name; `one_sided` (L,): whether all triangles of a light are."""
    specs, found = array_specs(EmissiveLights), [bvh for bvh in bvhs if bvh is not None]
    tables = {
        name: np.concatenate(
            [specs[name].empty(), *(rows for bvh in found if (rows := getattr(bvh, name[len(PREFIX) :])) is not None)]
        )
        for name in specs
        if name.startswith(PREFIX) and name != "node_one_sided"
    }
    nodes = [2 * bvh.leaves if bvh is not None else 0 for bvh in bvhs]
    return tables | {"node_one_sided": np.repeat(one_sided, nodes)}
