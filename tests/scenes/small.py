# SPDX-License-Identifier: GPL-3.0-or-later
"""Three small scenes as arrays, for comparison with a plain reference renderer."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from ism_addon.scene import Lights, LightShape, Mesh, Scene, View, World
from tests.scenes.parts.tables import instances_of, materials_of

#: Shape, position (m), target (m), size (m), watts and spread (rad).
AreaLight = tuple[LightShape, Sequence[float], Sequence[float], tuple[float, float], float, float]


def box_over_plane(width: int = 96, height: int = 64) -> tuple[Scene, View]:
    """A box above a plane, below a square light: one umbra with its penumbra."""
    meshes = [
        subdivided_box((-4.0, -4.0, -0.1), (4.0, 4.0, 0.0), 8),
        subdivided_box((-0.5, -0.4, 0.6), (0.5, 0.4, 1.0), 3),
    ]
    light = (LightShape.RECTANGLE, (0.8, -0.6, 3.2), (0.0, 0.0, 0.5), (0.9, 0.9), 12.0, math.pi)
    return scene(meshes, [light]), view((3.2, -3.6, 2.6), (0.0, 0.0, 0.3), width, height)


def sphere_in_corner(width: int = 96, height: int = 64) -> tuple[Scene, View]:
    """A finely tessellated sphere in the corner of a room, below a disk light and a rectangular one."""
    floor = subdivided_box((-0.2, -0.2, -0.2), (3.0, 3.0, 0.0), 6)
    walls = [subdivided_box((-0.2, 0.0, 0.0), (0.0, 3.0, 2.6), 6), subdivided_box((0.0, -0.2, 0.0), (3.0, 0.0, 2.6), 6)]
    area_lights = [
        (LightShape.ELLIPSE, (2.2, 1.2, 2.5), (0.9, 0.9, 0.4), (0.7, 0.7), 14.0, math.pi),
        (LightShape.RECTANGLE, (1.0, 2.6, 1.8), (0.8, 0.8, 0.6), (1.0, 0.3), 9.0, math.pi),
    ]
    meshes = [floor, *walls, sphere((1.0, 1.0, 0.55), 0.5, 40, 24)]
    return scene(meshes, area_lights), view((3.6, 3.2, 2.0), (0.7, 0.7, 0.6), width, height)


def pillar_field(width: int = 96, height: int = 64) -> tuple[Scene, View]:
    """Thin pillars below an elliptical light of narrow spread: many penumbrae that overlap."""
    floor = subdivided_box((-3.0, -3.0, -0.1), (3.0, 3.0, 0.0), 8)
    pillar = subdivided_box((-0.06, -0.06, 0.0), (0.06, 0.06, 1.2), 2)
    feet = np.stack(np.meshgrid(np.linspace(-1.5, 1.5, 5), np.linspace(-1.5, 1.5, 5)), -1).reshape(-1, 2)
    light = (LightShape.ELLIPSE, (-2.2, -1.4, 3.0), (0.0, 0.0, 0.2), (1.2, 0.5), 30.0, math.radians(110.0))
    positions = np.concatenate([np.zeros((1, 3)), np.pad(feet, ((0, 0), (0, 1)))])
    mesh_ids = np.array([0] + [1] * len(feet))
    return scene([floor, pillar], [light], mesh_ids, positions), view((2.6, -4.2, 2.7), (0.0, 0.0, 0.4), width, height)


#: Scenes by name: a function of width and height in pixels that makes a scene and its view.
SMALL: dict[str, Callable[..., tuple[Scene, View]]] = {
    "box over plane": box_over_plane,
    "sphere in corner": sphere_in_corner,
    "pillar field": pillar_field,
}


def scene(
    meshes: Sequence[Mesh],
    area_lights: Sequence[AreaLight],
    mesh_ids: np.ndarray | None = None,
    positions: np.ndarray | None = None,
) -> Scene:
    """Grey meshes, area lights and a dim world: each mesh once, or instances of mesh ids (I,) at positions (I,3)."""
    ids = np.arange(len(meshes)) if mesh_ids is None else mesh_ids
    world_from_object = np.tile(np.eye(4), (len(ids), 1, 1))
    if positions is not None:
        world_from_object[:, :3, 3] = positions
    return Scene(
        meshes=tuple(meshes),
        instances=instances_of(ids, world_from_object),
        materials=materials_of([(0.6, 0.6, 0.6)]),
        images=(),
        lights=lights(area_lights),
        world=World.even(np.full(3, 0.05, np.float32)),
    )


def lights(area_lights: Sequence[AreaLight]) -> Lights:
    """The table of area lights. Their radiance is watts / (pi area)."""
    axes = [basis(np.array(target) - position) for _, position, target, *_ in area_lights]
    sizes = np.array([light[3] for light in area_lights])
    shapes = np.array([light[0] for light in area_lights], np.int32)
    area = sizes.prod(axis=1) * np.where(shapes == LightShape.ELLIPSE, math.pi / 4.0, 1.0)
    radiance = np.array([light[4] for light in area_lights]) / (math.pi * area)
    return Lights(
        shape=shapes,
        position=np.array([light[1] for light in area_lights], np.float64),
        axis_u=np.array([right for right, _, _ in axes]) * sizes[:, :1],
        axis_v=np.array([up for _, up, _ in axes]) * sizes[:, 1:],
        normal=np.array([forward for _, _, forward in axes]),
        emission=np.repeat(radiance[:, None], 3, axis=1).astype(np.float32),
        spread=np.array([light[5] for light in area_lights], np.float32),
        blend=np.zeros(len(area_lights), np.float32),
        radius=np.zeros(len(area_lights)),
        soft_falloff=np.zeros(len(area_lights), bool),
        visible_camera=np.zeros(len(area_lights), bool),
        shadow_softness=np.ones(len(area_lights), np.float32),
        falloff_power=np.zeros(len(area_lights), np.int32),
        falloff_smooth=np.zeros(len(area_lights), np.float32),
        profile=np.full(len(area_lights), -1, np.int32),
        image=np.full(len(area_lights), -1, np.int32),
        profile_axes=np.zeros((len(area_lights), 3, 3)),
        casts_shadow=np.ones(len(area_lights), bool),
        receivers=np.full(len(area_lights), -1, np.int32),
        blockers=np.full(len(area_lights), -1, np.int32),
    )


def view(position: Sequence[float], target: Sequence[float], width: int, height: int) -> View:
    """A camera at a position, aimed at a target: 50 degrees wide, pixels sampled at their centres."""
    right, up, forward = basis(np.array(target) - position)
    view_from_world = np.eye(4)
    view_from_world[:3, :3] = right, up, -forward
    view_from_world[:3, 3] = -view_from_world[:3, :3] @ position
    clip_from_view = perspective(math.radians(50.0), width / height, 0.1, 100.0)
    return View(clip_from_view, view_from_world, width, height, filter_width=0.01)


def perspective(angle_across: float, aspect: float, near: float, far: float) -> np.ndarray:
    """(4,4): from a view space that looks along -z to OpenGL's clip space."""
    across = 1.0 / math.tan(0.5 * angle_across)
    matrix = np.diag([across, across * aspect, (far + near) / (near - far), 0.0])
    matrix[2, 3], matrix[3, 2] = 2.0 * far * near / (near - far), -1.0
    return matrix


def basis(direction: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Unit vectors right, up and forward of a direction (3,) that is not vertical."""
    forward = direction / np.linalg.norm(direction)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    return right, np.cross(right, forward), forward


def subdivided_box(low: Sequence[float], high: Sequence[float], divisions: int) -> Mesh:
    """A closed box with `divisions` × `divisions` quads a side: 12 divisions² triangles."""
    line = np.linspace(0.0, 1.0, divisions + 1)
    u, v = np.meshgrid(line, line, indexing="ij")
    positions, triangles = [], []
    for axis in range(3):
        for end in (0.0, 1.0):
            corner = np.empty((*u.shape, 3))
            corner[..., axis], corner[..., (axis + 1) % 3], corner[..., (axis + 2) % 3] = end, u, v
            triangles.append(grid_triangles(*u.shape, flipped=end == 0.0) + len(positions) * u.size)
            positions.append(corner.reshape(-1, 3))
    points = np.asarray(low) + np.concatenate(positions) * (np.asarray(high) - low)
    return mesh(points, np.concatenate(triangles))


def sphere(centre: Sequence[float], radius: float, around: int, along: int) -> Mesh:
    """A sphere with smooth normals: 2 around (along - 1) triangles."""
    theta, phi = np.linspace(0.0, np.pi, along + 1), np.linspace(0.0, 2.0 * np.pi, around + 1)
    directions = np.stack(
        [
            np.outer(np.sin(theta), np.cos(phi)),
            np.outer(np.sin(theta), np.sin(phi)),
            np.outer(np.cos(theta), 1.0 + 0.0 * phi),
        ],
        -1,
    ).reshape(-1, 3)
    triangles = grid_triangles(along + 1, around + 1)
    corners = directions[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    triangles = triangles[area > 1e-9]
    return mesh(centre + radius * directions, triangles, directions[triangles])


def grid_triangles(rows: int, columns: int, flipped: bool = False) -> np.ndarray:
    """Two triangles for each cell of a grid of points: (T,3)."""
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    triangles = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    return triangles[:, ::-1] if flipped else triangles


def mesh(positions: np.ndarray, triangles: np.ndarray, normals: np.ndarray | None = None) -> Mesh:
    """A mesh of the first material. Without normals (T,3,3) it is flat-shaded."""
    if normals is None:
        corners = positions[triangles]
        crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals = np.repeat(crosses[:, None] / np.linalg.norm(crosses, axis=1)[:, None, None], 3, axis=1)
    return Mesh(
        positions=positions.astype(np.float32),
        triangles=np.ascontiguousarray(triangles, np.uint32),
        normals=normals.astype(np.float32),
        uvs=np.zeros((0, 3, 2), np.float32),
        materials=np.zeros(len(triangles), np.uint32),
    )
