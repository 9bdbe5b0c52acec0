# SPDX-License-Identifier: GPL-3.0-or-later
"""A room with five area lights, and any number of further lights that do not contribute to its picture."""

import math
from collections.abc import Callable

import numpy as np

from ism_addon.scene import LightShape, Scene, View

from .small import AreaLight, scene, sphere, subdivided_box, view

#: m: a room's size, and the thickness of its walls.
SIZE = np.array([6.0, 5.0, 3.0])
WALL = 0.1
#: Rooms along each axis, and the one that the camera is in: in the middle.
ROOMS = (8, 8, 3)
VISIBLE_ROOM = (4, 4, 1)


def room_corner(room: tuple[int, ...]) -> np.ndarray:
    """(3,) m, the lowest corner of a room's inside; that of the visible one is the origin."""
    return (np.array(room) - VISIBLE_ROOM) * (SIZE + WALL)


def contributing_lights() -> list[AreaLight]:
    """The five lights of the visible room."""
    below = (0.0, 0.0, -1.0)
    positions = [(1.2, 1.2, 2.8), (4.8, 1.3, 2.7), (3.0, 2.5, 2.9), (1.3, 3.8, 2.6), (4.7, 3.9, 2.8)]
    sizes = [(0.5, 0.5), (0.9, 0.2), (0.6, 0.6), (0.3, 0.3), (0.4, 0.8)]
    shapes = [LightShape.RECTANGLE, LightShape.RECTANGLE, LightShape.ELLIPSE, LightShape.ELLIPSE, LightShape.RECTANGLE]
    return [
        (shape, position, tuple(np.add(position, below) + (0.2, 0.1 * index, 0.0)), size, 25.0, math.pi)
        for index, (shape, position, size) in enumerate(zip(shapes, positions, sizes, strict=True))
    ]


def light_in_other_room(index: int) -> AreaLight:
    others = [room for room in np.ndindex(ROOMS) if room != VISIBLE_ROOM]
    near = sorted(others, key=lambda room: float(np.abs(room_corner(room)).sum()))[index % len(others)]
    position = room_corner(near) + SIZE * (0.5, 0.4 + 0.2 * (index // len(others)), 0.9)
    return LightShape.RECTANGLE, tuple(position), tuple(position + (0.1, 0.2, -1.0)), (0.5, 0.5), 25.0, math.pi


def light_facing_away(index: int) -> AreaLight:
    """Faces the wall behind the camera, from close to it: it lights nothing that the camera sees."""
    position = np.array([0.1 + 0.029 * index, 0.02, 2.0])
    return LightShape.RECTANGLE, tuple(position), tuple(position + (0.01, -1.0, 0.0)), (0.02, 0.4), 5.0, math.pi


def light_with_narrow_spread(index: int) -> AreaLight:
    """Shines upwards from below the ceiling; its spread is too narrow for it to light anything visible."""
    angle = 2.4 * index
    position = np.array([3.0 + 2.0 * math.cos(angle), 2.5 + 1.5 * math.sin(angle), 2.95])
    target = position + (0.001, 0.002, 1.0)
    return LightShape.ELLIPSE, tuple(position), tuple(target), (0.1, 0.1), 10.0, math.radians(30.0)


def faint_light(index: int) -> AreaLight:
    """Near the five lights, but too faint to see: all of these together emit less than a thousandth of their light."""
    angle = 2.4 * index
    position = np.array([3.0 + 2.0 * math.cos(angle), 2.5 + 1.5 * math.sin(angle), 2.9])
    return LightShape.RECTANGLE, tuple(position), tuple(position + (0.1, 0.2, -1.0)), (0.2, 0.2), 1e-4, math.pi


#: Reasons why a light does not contribute: the function that makes such lights.
IDLE: dict[str, Callable[[int], AreaLight]] = {
    "hidden": light_in_other_room,
    "turned away": light_facing_away,
    "elsewhere": light_with_narrow_spread,
    "faint": faint_light,
}


def rooms(idle: dict[str, int], width: int = 640, height: int = 360) -> tuple[Scene, View]:
    """The room with its five lights, and `idle` further ones: how many for each reason in IDLE."""
    lights = contributing_lights() + [IDLE[why](index) for why, count in idle.items() for index in range(count)]
    meshes = [
        subdivided_box(np.full(3, -WALL), (SIZE[0], 0.0, SIZE[2]), 8),
        subdivided_box(np.full(3, -WALL), (0.0, SIZE[1], SIZE[2]), 8),
        subdivided_box(np.full(3, -WALL), (SIZE[0], SIZE[1], 0.0), 8),
        sphere((0.0, 0.0, 0.0), 0.4, 60, 40),
        subdivided_box((-0.3, -0.3, 0.0), (0.3, 0.3, 1.1), 6),
    ]
    walls = [(mesh, room_corner(room)) for room in np.ndindex(*(np.array(ROOMS) + 1)) for mesh in range(3)]
    furniture = [(3, (2.0, 3.0, 0.4)), (3, (4.1, 2.2, 0.9)), (4, (3.0, 3.8, 0.0)), (4, (4.1, 2.2, -0.6))]
    mesh_ids, positions = zip(*walls, *furniture, strict=True)
    made = scene(meshes, lights, np.array(mesh_ids), np.array(positions))
    return made, view((0.6, 0.4, 1.7), (3.2, 3.0, 0.9), width, height)
