# SPDX-License-Identifier: GPL-3.0-or-later
"""A plain reference renderer: rays against triangles, lights as grids of points. Float64, world space."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from ism_addon.scene import LightShape, Scene, View
from ism_addon.spaces import orthonormal
from tests.support.light_grids import SUN_DISTANCE, grid_on_light, irradiance_per_area

#: Pairs of a ray and a triangle that are tested at a time, so that they stay in the processor's cache.
PAIRS_AT_A_TIME = 1 << 16


# --- rays and triangles


def world_triangles(scene: Scene, which: np.ndarray) -> np.ndarray:
    """(T,3,3) corners of all triangles, instance by instance, of the instances selected by `which` (I,) bool."""
    parts = [np.zeros((0, 3, 3))]
    for row in np.flatnonzero(which):
        mesh, matrix = scene.meshes[scene.instances.mesh[row]], scene.instances.world_from_object[row]
        corners = mesh.positions.astype(np.float64)[mesh.triangles]
        parts.append(corners @ matrix[:3, :3].T + matrix[:3, 3])
    return np.concatenate(parts)


def intersections(origins: np.ndarray, directions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(N,T): the t at which each ray (N,3) + t (N,3) hits each triangle; inf if it does not.

    A line crosses a triangle if it passes the three edges on the same side (by the product of Plücker coordinates).
    """
    moments = np.cross(origins, directions)
    sides = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        start, end = triangles[:, a], triangles[:, b]
        sides.append(directions @ np.cross(start, end).T + moments @ (end - start).T)
    inside = (np.minimum(np.minimum(*sides[:2]), sides[2]) >= 0.0) | (
        np.maximum(np.maximum(*sides[:2]), sides[2]) <= 0.0
    )
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        t = ((normals * triangles[:, 0]).sum(1) - origins @ normals.T) / (directions @ normals.T)
    return np.where(inside & (t > 0.0), t, np.inf)


def nearest(origins: np.ndarray, directions: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Index (N,) of the nearest triangle that each ray hits, -1: none; and its t (N,), inf: none."""
    index, t = np.full(len(origins), -1), np.full(len(origins), np.inf)
    step = max(PAIRS_AT_A_TIME // max(len(triangles), 1), 1)
    for first in range(0, len(origins) if len(triangles) else 0, step):
        rows = slice(first, first + step)
        hits = intersections(origins[rows], directions[rows], triangles)
        index[rows] = hits.argmin(1)
        t[rows] = hits.min(1)
    return np.where(np.isfinite(t), index, -1), t


def visible(
    points: np.ndarray,
    emitters: np.ndarray,
    triangles: np.ndarray,
    slack: float = 1e-4,
    counts: np.ndarray | None = None,
) -> np.ndarray:
    """(E,N) bool: whether no triangle is between emitters (E,3) and points (N,3).

    Triangles within the fraction `slack` of a ray from either of its ends do not count. Only pairs that `counts` (E,N)
    are tested, the others are invisible.
    """
    is_visible = np.ones((len(emitters), len(points)), bool) if counts is None else counts.copy()
    pairs = np.stack(np.nonzero(is_visible))
    for first in range(0, pairs.shape[1], PAIRS_AT_A_TIME):
        emitter, point = pairs[:, first : first + PAIRS_AT_A_TIME]
        ends = points[point], emitters[emitter] - points[point]
        is_visible[emitter, point] = ~occluded(*ends, triangles, slack)
    return is_visible


def occluded(origins: np.ndarray, directions: np.ndarray, triangles: np.ndarray, slack: float) -> np.ndarray:
    """(N,) bool: whether any triangle is between origins (N,3) and origins + directions (N,3), as in `visible`.

    Many triangles are halved, by where they are, and tested against the rays that come through the box around them.
    """
    corners = triangles.reshape(-1, 3)
    result = np.zeros(len(origins), bool)
    if not len(triangles):
        return result
    low, high = corners.min(0), corners.max(0)
    near = np.flatnonzero(box_is_hit(origins, directions, low - 1e-6, high + 1e-6))
    origins, directions = origins[near], directions[near]
    if len(triangles) <= 16:
        middle = 0.5 * (low + high)  # far from the origin, the products in `intersections` would lose precision
        t = intersections(origins - middle, directions, triangles - middle)
        result[near] = ((t > slack) & (t < 1.0 - slack)).any(1)
    elif len(near):
        order = np.argsort(triangles.mean(1)[:, (high - low).argmax()])
        for half in np.array_split(order, 2):
            rest = np.flatnonzero(~result[near])
            result[near[rest]] = occluded(origins[rest], directions[rest], triangles[half], slack)
    return result


def box_is_hit(origins: np.ndarray, directions: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """(N,) bool: whether the way from origins (N,3) to origins + directions (N,3) touches a box."""
    enter, leave = np.zeros(len(origins)), np.ones(len(origins))
    for origin, direction, first, last in zip(origins.T, directions.T, low, high, strict=True):
        with np.errstate(divide="ignore", invalid="ignore"):
            a, b = (first - origin) / direction, (last - origin) / direction
        enter, leave = np.fmax(enter, np.fmin(a, b)), np.fmin(leave, np.fmax(a, b))
    return enter <= leave


# --- visible surfaces


@dataclass
class Surface:
    """The surfaces that camera rays through the pixels' centres hit: N pixels, bottom row first."""

    exists: np.ndarray  # (N,) bool: whether there is a surface
    triangle: np.ndarray  # (N,) index into world_triangles of the visible instances
    position: np.ndarray  # (N,3) world
    barycentric: np.ndarray  # (N,3)
    geometric_normal: np.ndarray  # (N,3) unit geometric normal, towards the camera
    depth: np.ndarray  # (N,) m along the camera's axis


def view_rays(view: View) -> tuple[np.ndarray, np.ndarray]:
    """Origins (N,3) on the near plane and directions (N,3) to the far one, of the pixels' centres, bottom row first."""
    x, y = np.meshgrid(
        2 * (np.arange(view.width) + 0.5) / view.width - 1, 2 * (np.arange(view.height) + 0.5) / view.height - 1
    )
    view_from_clip, world_from_view = np.linalg.inv(view.clip_from_view), np.linalg.inv(view.view_from_world)
    ends = []
    for z in (-1.0, 1.0):
        clip = np.stack([x.ravel(), y.ravel(), np.full(x.size, z), np.ones(x.size)], 1)
        in_view = clip @ view_from_clip.T
        ends.append((in_view[:, :3] / in_view[:, 3:]) @ world_from_view[:3, :3].T + world_from_view[:3, 3])
    return ends[0], ends[1] - ends[0]


def surfaces(scene: Scene, view: View) -> Surface:
    """The nearest surface at each pixel."""
    triangles = world_triangles(scene, scene.instances.visible)
    origins, directions = view_rays(view)
    middle = origins.mean(0)  # far from the world's origin, the products in `intersections` would lose precision
    index, t = nearest(origins - middle, directions, triangles - middle)
    seen = index >= 0
    a, b, c = np.moveaxis(triangles[index], 1, 0) if len(triangles) else np.zeros((3, len(index), 3))
    position = origins + np.where(seen, t, 0.0)[:, None] * directions
    normal = np.cross(b - a, c - a)
    square = np.maximum((normal**2).sum(1), 1e-300)
    second = (np.cross(position - a, c - a) * normal).sum(1) / square
    third = (np.cross(b - a, position - a) * normal).sum(1) / square
    facet = normal / np.sqrt(square)[:, None] * np.where((normal * directions).sum(1) > 0.0, -1.0, 1.0)[:, None]
    depth = -(position @ view.view_from_world[2, :3] + view.view_from_world[2, 3])
    return Surface(seen, index, position, np.stack([1.0 - second - third, second, third], 1), facet, depth)


def shading_normals(scene: Scene, surface: Surface) -> np.ndarray:
    """(N,3) unit: the interpolated normals of the corners, on the visible side of the triangle."""
    parts = [np.zeros((0, 3, 3))]
    for row in np.flatnonzero(scene.instances.visible):
        mesh, linear = scene.meshes[scene.instances.mesh[row]], scene.instances.world_from_object[row, :3, :3]
        parts.append(mesh.corner_normals.astype(np.float64) @ np.linalg.inv(linear))
    normals = np.concatenate(parts)[surface.triangle]
    interpolated = np.einsum("nk,nkc->nc", surface.barycentric, normals)
    interpolated /= np.maximum(np.linalg.norm(interpolated, axis=1, keepdims=True), 1e-300)
    corners = world_triangles(scene, scene.instances.visible)[surface.triangle]
    geometric_normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    mirrored = mirrored_triangles(scene)[surface.triangle]
    side = np.sign((geometric_normal * surface.geometric_normal).sum(1)) * np.where(mirrored, -1.0, 1.0)
    return interpolated * side[:, None]


def mirrored_triangles(scene: Scene) -> np.ndarray:
    """(T,) bool: whether the transform of a triangle's instance mirrors it."""
    rows = np.flatnonzero(scene.instances.visible)
    counts = [len(scene.meshes[scene.instances.mesh[row]].triangles) for row in rows]
    return np.repeat(np.linalg.det(scene.instances.world_from_object[rows, :3, :3]) < 0.0, counts)


def picture(scene: Scene, view: View, side: int = 10) -> tuple[np.ndarray, Surface]:
    """(N,3) linear light at the pixels' centres without ambient occlusion, and the surfaces there.

    Each light is side² points, each with its own irradiance and visibility: without closed forms and shadow maps.
    """
    surface = surfaces(scene, view)
    normals = shading_normals(scene, surface)
    blockers = world_triangles(scene, scene.instances.casts_shadow)
    total_irradiance = np.zeros((len(normals), 3))
    for light in range(len(scene.lights.shape)):
        emitters, cell_area = grid_on_light(scene.lights, light, side)
        contributions = irradiance_per_area(surface.position, normals, emitters[:, None], scene.lights, light)
        lit = np.flatnonzero(surface.exists & (contributions > 0.0).any(0))
        contributions = contributions[:, lit]
        if scene.lights.casts_shadow[light]:
            starts = surface.position[lit] + 1e-4 * surface.geometric_normal[lit]
            slack = 1e-4 / (SUN_DISTANCE if scene.lights.shape[light] == LightShape.SUN else 1.0)
            contributions = contributions * visible(starts, emitters, blockers, slack, contributions > 0.0)
        total_irradiance[lit] += np.outer(contributions.sum(0) * cell_area, scene.lights.emission[light])
    base_color = scene.materials.base_color[0].astype(np.float64)
    color = base_color * (total_irradiance / np.pi + scene.world.radiance)
    return np.where(surface.exists[:, None], color, scene.world.radiance), surface


@cache
def picture_of(make: Callable[[int, int], tuple[Scene, View]], width: int, height: int, side: int) -> np.ndarray:
    """`picture` of a scene that several tests make: (N,3), computed once."""
    return picture(*make(width, height), side)[0]


# --- ambient occlusion


def ambient_visibility(
    points: np.ndarray,
    normals: np.ndarray,
    triangles: np.ndarray,
    camera: np.ndarray,
    radius: float,
    cone_angle: float,
    attenuation: float,
) -> np.ndarray:
    """(N,): 1 minus the mean occlusion, as seen by the camera (3,), of samples in a cone about the normal.

    Directions of samples are cosine-distributed in the cone, squares of their distances uniform up to the radius r.
    A surface that occludes one counts 1 / (1 + attenuation (d / r)²) if its distance d from the point is at most r.
    """
    a, b, c = (grid.ravel() for grid in np.meshgrid(*[(np.arange(n) + 0.5) / n for n in (8, 16, 8)]))
    sine = np.sin(cone_angle / 2.0) * np.sqrt(a)
    cone = np.column_stack([sine * np.cos(2 * np.pi * b), sine * np.sin(2 * np.pi * b), np.sqrt(1.0 - sine**2)])
    tangents = orthonormal(normals)
    visibility = np.empty(len(points))
    for row, (point, normal) in enumerate(zip(points, normals, strict=True)):
        directions = cone @ np.stack([tangents[0][row], tangents[1][row], normal])
        to_samples = point + radius * np.sqrt(c)[:, None] * directions - camera
        _, t = nearest(np.tile(camera, (len(to_samples), 1)), to_samples, triangles)
        relative_distance = np.linalg.norm(camera + np.minimum(t, 1.0)[:, None] * to_samples - point, axis=1) / radius
        is_occluder = (t < 1.0 - 1e-5) & (relative_distance <= 1.0)
        visibility[row] = 1.0 - np.where(is_occluder, 1.0 / (1.0 + attenuation * relative_distance**2), 0.0).mean()
    return visibility


def ray_traced_occlusion(
    points: np.ndarray, normals: np.ndarray, triangles: np.ndarray, radius: float, cone_angle: float, attenuation: float
) -> np.ndarray:
    """(N,): 1 minus the mean occlusion of rays in a cone about the normal, cosine-distributed.

    A surface that a ray hits at a distance d up to the radius r counts (1 - (d / r)²)^attenuation.
    """
    a, b = (grid.ravel() for grid in np.meshgrid(*[(np.arange(n) + 0.5) / n for n in (16, 32)]))
    sine = np.sin(cone_angle / 2.0) * np.sqrt(a)
    cone = np.column_stack([sine * np.cos(2 * np.pi * b), sine * np.sin(2 * np.pi * b), np.sqrt(1.0 - sine**2)])
    tangents, visibility = orthonormal(normals), np.empty(len(points))
    for row, (point, normal) in enumerate(zip(points, normals, strict=True)):
        directions = cone @ np.stack([tangents[0][row], tangents[1][row], normal])
        _, t = nearest(np.tile(point + 1e-5 * normal, (len(directions), 1)), directions, triangles)
        square = np.minimum(t / radius, 1.0) ** 2
        visibility[row] = 1.0 - np.where(t <= radius, (1.0 - square) ** attenuation, 0.0).mean()
    return visibility


def nrmse(picture: np.ndarray, truth: np.ndarray) -> float:
    """Root mean square difference, relative to the mean of the reference image."""
    return float(np.sqrt(((picture - truth) ** 2).mean()) / truth.mean())
