# SPDX-License-Identifier: GPL-3.0-or-later
"""The truth, slowly: every ray against every triangle, every light as a dense grid of points. Float64, world space."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from ism_addon.scene import Lights, LightShape, Scene, View
from ism_addon.spaces import orthonormal

#: Pairs of a ray and a triangle that are tested at a time, so that they stay in the processor's cache.
PAIRS_AT_A_TIME = 1 << 16


# --- rays and triangles


def world_triangles(scene: Scene, which: np.ndarray) -> np.ndarray:
    """(T,3,3) corners of the triangles of the instances `which` (I,) bool, one instance after the other."""
    parts = [np.zeros((0, 3, 3))]
    for row in np.flatnonzero(which):
        mesh, matrix = scene.meshes[scene.instances.mesh[row]], scene.instances.world_from_object[row]
        corners = mesh.positions.astype(np.float64)[mesh.triangles]
        parts.append(corners @ matrix[:3, :3].T + matrix[:3, 3])
    return np.concatenate(parts)


def intersections(origins: np.ndarray, directions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(N,T): how many directions away each ray (N,3) + t (N,3) meets each triangle; inf where it does not.

    A line passes a triangle where it passes its three edges on the same side (Plücker's product).
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
        along = ((normals * triangles[:, 0]).sum(1) - origins @ normals.T) / (directions @ normals.T)
    return np.where(inside & (along > 0.0), along, np.inf)


def nearest(origins: np.ndarray, directions: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The first triangle (N,) that each ray meets, -1: none; and how many directions away (N,), inf: none."""
    index, along = np.full(len(origins), -1), np.full(len(origins), np.inf)
    step = max(PAIRS_AT_A_TIME // max(len(triangles), 1), 1)
    for first in range(0, len(origins) if len(triangles) else 0, step):
        rows = slice(first, first + step)
        found = intersections(origins[rows], directions[rows], triangles)
        index[rows] = found.argmin(1)
        along[rows] = found.min(1)
    return np.where(np.isfinite(along), index, -1), along


def visible(points: np.ndarray, emitters: np.ndarray, triangles: np.ndarray, slack: float = 1e-4) -> np.ndarray:
    """(E,N) bool: whether no triangle is between emitters (E,3) and points (N,3), but for `slack` of both ends."""
    found = np.ones((len(emitters), len(points)), bool)
    columns = max(PAIRS_AT_A_TIME // max(len(triangles), 1), 1)
    rows = max(PAIRS_AT_A_TIME // max(len(triangles) * min(columns, len(points)), 1), 1)
    for row in range(0, len(emitters), rows):
        origins = emitters[row : row + rows]
        a, b, c = np.moveaxis(triangles - origins[:, None, None], 2, 0)
        edges = [np.cross(*pair).swapaxes(1, 2) for pair in ((a, b), (b, c), (c, a))]
        normals = np.cross(b - a, c - a)
        heights = (normals * a).sum(2)[:, None]
        for column in range(0, len(points), columns):
            rays = points[column : column + columns] - origins[:, None]
            first, second, third = (rays @ edge for edge in edges)
            inside = (np.minimum(np.minimum(first, second), third) >= 0.0) | (
                np.maximum(np.maximum(first, second), third) <= 0.0
            )
            with np.errstate(divide="ignore", invalid="ignore"):
                along = heights / (rays @ normals.swapaxes(1, 2))
            hidden = (inside & (along > slack) & (along < 1.0 - slack)).any(2)
            found[row : row + rows, column : column + columns] = ~hidden
    return found


# --- lights


def grid_on_light(lights: Lights, light: int, side: int) -> tuple[np.ndarray, float]:
    """(side²,3) points, each in the middle of an equal share of the light; and that share, m²."""
    middle = (np.arange(side) + 0.5) / side
    a, b = (grid.ravel() for grid in np.meshgrid(middle, middle, indexing="ij"))
    area = np.linalg.norm(np.cross(lights.axis_u[light], lights.axis_v[light]))
    u, v = a - 0.5, b - 0.5
    if lights.shape[light] == LightShape.ELLIPSE:
        u, v = 0.5 * np.sqrt(a) * np.cos(2 * np.pi * b), 0.5 * np.sqrt(a) * np.sin(2 * np.pi * b)
        area *= np.pi / 4.0
    return lights.position[light] + np.outer(u, lights.axis_u[light]) + np.outer(
        v, lights.axis_v[light]
    ), area / side**2


def spread_factor(spread: float, cosine: np.ndarray) -> np.ndarray:
    """Part of the radiance that a light sends at angles of `cosine` off its normal, with its watts unchanged."""
    half = max(spread, np.radians(1.0)) / 2.0
    if half > np.pi / 2.0 - 1e-4:
        return np.ones_like(cosine)
    tangent = np.sqrt(np.maximum(1.0 - cosine**2, 0.0)) / np.maximum(cosine, 1e-20)
    return np.maximum(np.tan(half) - tangent, 0.0) / (np.tan(half) - half)


def irradiance_per_area(
    points: np.ndarray, normals: np.ndarray, emitters: np.ndarray, lights: Lights, light: int
) -> np.ndarray:
    """Irradiance (…) per area and radiance that receivers (…,3) get from places (…,3) on a light."""
    way = emitters - points
    square = (way**2).sum(-1)
    receiver = np.maximum((normals * way).sum(-1), 0.0)
    sender = np.maximum(-way @ lights.normal[light], 0.0)
    return receiver * sender / square**2 * spread_factor(lights.spread[light], sender / np.sqrt(square))


def irradiance(point: np.ndarray, normal: np.ndarray, lights: Lights, light: int, side: int = 300) -> float:
    """W/m² at one receiver, for a light of radiance 1 that nothing hides.

    From afar a sum over the light; from near by over the receiver's directions, spread by the cosine
    (Nusselt's disk): each where it converges.
    """
    size = max(np.linalg.norm(lights.axis_u[light]), np.linalg.norm(lights.axis_v[light]))
    if np.linalg.norm(lights.position[light] - point) > 1.5 * size:
        emitters, share = grid_on_light(lights, light, side)
        return float(irradiance_per_area(point, normal, emitters, lights, light).sum() * share)
    u, v = np.meshgrid(*[(np.arange(4 * side) + 0.5) / (2 * side) - 1.0] * 2)
    u, v = u[u**2 + v**2 < 1.0], v[u**2 + v**2 < 1.0]
    directions = np.column_stack([u, v, np.sqrt(1.0 - u**2 - v**2)]) @ np.stack([*orthonormal(normal), normal])
    cosine = -directions @ lights.normal[light]
    with np.errstate(divide="ignore", invalid="ignore"):
        along = ((point - lights.position[light]) @ lights.normal[light]) / cosine
        met = point + along[:, None] * directions - lights.position[light]
    axes = np.stack([lights.axis_u[light], lights.axis_v[light]])
    a, b = np.abs((met @ axes.T) / (axes**2).sum(1)).T
    inside = (a**2 + b**2 < 0.25) if lights.shape[light] == LightShape.ELLIPSE else (a < 0.5) & (b < 0.5)
    factor = np.where(inside & (cosine > 0.0) & (along > 0.0), spread_factor(lights.spread[light], cosine), 0.0)
    return float(factor.sum() / (2 * side) ** 2)


# --- what a camera sees


@dataclass
class Surface:
    """What the rays through the pixels' centres meet: N pixels, bottom row first."""

    seen: np.ndarray  # (N,) bool
    triangle: np.ndarray  # (N,) into world_triangles of all that is visible
    position: np.ndarray  # (N,3) world
    barycentric: np.ndarray  # (N,3)
    facet: np.ndarray  # (N,3) unit, towards the camera
    depth: np.ndarray  # (N,) m along the view's axis


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
    middle = origins.mean(0)  # far from the world's origin the products of crossings would lose digits
    index, along = nearest(origins - middle, directions, triangles - middle)
    seen = index >= 0
    a, b, c = np.moveaxis(triangles[index], 1, 0) if len(triangles) else np.zeros((3, len(index), 3))
    position = origins + np.where(seen, along, 0.0)[:, None] * directions
    normal = np.cross(b - a, c - a)
    square = np.maximum((normal**2).sum(1), 1e-300)
    second = (np.cross(position - a, c - a) * normal).sum(1) / square
    third = (np.cross(b - a, position - a) * normal).sum(1) / square
    facet = normal / np.sqrt(square)[:, None] * np.where((normal * directions).sum(1) > 0.0, -1.0, 1.0)[:, None]
    depth = -(position @ view.view_from_world[2, :3] + view.view_from_world[2, 3])
    return Surface(seen, index, position, np.stack([1.0 - second - third, second, third], 1), facet, depth)


def shading_normals(scene: Scene, surface: Surface) -> np.ndarray:
    """(N,3) unit: the corners' normals, interpolated, on the side of the facet that is seen."""
    parts = [np.zeros((0, 3, 3))]
    for row in np.flatnonzero(scene.instances.visible):
        mesh, linear = scene.meshes[scene.instances.mesh[row]], scene.instances.world_from_object[row, :3, :3]
        parts.append(mesh.corner_normals.astype(np.float64) @ np.linalg.inv(linear))
    normals = np.concatenate(parts)[surface.triangle]
    smooth = np.einsum("nk,nkc->nc", surface.barycentric, normals)
    smooth /= np.maximum(np.linalg.norm(smooth, axis=1, keepdims=True), 1e-300)
    corners = world_triangles(scene, scene.instances.visible)[surface.triangle]
    facet = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    mirrored = mirrored_triangles(scene)[surface.triangle]
    side = np.sign((facet * surface.facet).sum(1)) * np.where(mirrored, -1.0, 1.0)
    return smooth * side[:, None]


def mirrored_triangles(scene: Scene) -> np.ndarray:
    """(T,) bool: whether the triangle stands in an instance that turns left into right."""
    rows = np.flatnonzero(scene.instances.visible)
    counts = [len(scene.meshes[scene.instances.mesh[row]].triangles) for row in rows]
    return np.repeat(np.linalg.det(scene.instances.world_from_object[rows, :3, :3]) < 0.0, counts)


def picture(scene: Scene, view: View, side: int = 10) -> tuple[np.ndarray, Surface]:
    """(N,3) linear light at the pixels' centres without ambient occlusion, and the surfaces there.

    Each light is side² points, each with its own irradiance and its own visibility: no exact irradiance, no map.
    """
    surface = surfaces(scene, view)
    normals = shading_normals(scene, surface)
    blockers = world_triangles(scene, scene.instances.casts_shadow)
    arriving = np.zeros((len(normals), 3))
    for light in range(len(scene.lights.shape)):
        emitters, share = grid_on_light(scene.lights, light, side)
        parts = irradiance_per_area(surface.position, normals, emitters[:, None], scene.lights, light)
        lit = np.flatnonzero(surface.seen & (parts > 0.0).any(0))
        parts = parts[:, lit]
        if scene.lights.casts_shadow[light]:
            parts = parts * visible(surface.position[lit] + 1e-4 * surface.facet[lit], emitters, blockers)
        arriving[lit] += np.outer(parts.sum(0) * share, scene.lights.radiance[light])
    albedo = scene.materials.base_color[0].astype(np.float64)
    color = albedo * (arriving / np.pi + scene.world.radiance)
    return np.where(surface.seen[:, None], color, scene.world.radiance), surface


@cache
def picture_of(make: Callable[[int, int], tuple[Scene, View]], width: int, height: int, side: int) -> np.ndarray:
    """`picture` of a scene that is made anew for each test: (N,3), drawn once."""
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
    """(N,): 1 less the mean, over places in a cone about the normal, of what hides them from the camera (3,).

    Places are spread by the cosine within the cone and evenly in the square of their distance up to the radius r.
    What hides one counts 1 / (1 + attenuation (d / r)²) if its distance d from the point is no more than r.
    """
    a, b, c = (grid.ravel() for grid in np.meshgrid(*[(np.arange(n) + 0.5) / n for n in (8, 16, 8)]))
    sine = np.sin(cone_angle / 2.0) * np.sqrt(a)
    cone = np.column_stack([sine * np.cos(2 * np.pi * b), sine * np.sin(2 * np.pi * b), np.sqrt(1.0 - sine**2)])
    tangents = orthonormal(normals)
    opened = np.empty(len(points))
    for row, (point, normal) in enumerate(zip(points, normals, strict=True)):
        directions = cone @ np.stack([tangents[0][row], tangents[1][row], normal])
        way = point + radius * np.sqrt(c)[:, None] * directions - camera
        _, along = nearest(np.tile(camera, (len(way), 1)), way, triangles)
        part = np.linalg.norm(camera + np.minimum(along, 1.0)[:, None] * way - point, axis=1) / radius
        hides = (along < 1.0 - 1e-5) & (part <= 1.0)
        opened[row] = 1.0 - np.where(hides, 1.0 / (1.0 + attenuation * part**2), 0.0).mean()
    return opened


def nrmse(picture: np.ndarray, truth: np.ndarray) -> float:
    """Root of the mean squared difference over the truth's mean."""
    return float(np.sqrt(((picture - truth) ** 2).mean()) / truth.mean())
