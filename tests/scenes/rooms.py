# SPDX-License-Identifier: GPL-3.0-or-later
"""A room with five lamps, and as many more that change nothing in it: why, is what they are called by."""

import math
from collections.abc import Callable

import numpy as np

from ism_addon.scene import LightShape, Scene, View

from .small import Lamp, scene, sphere, subdivided_box, view

#: m: a room's size, and of its walls.
SIZE = np.array([6.0, 5.0, 3.0])
WALL = 0.1
#: Rooms along each axis; the one that is seen is in the middle.
ROOMS = (8, 8, 3)
SEEN = (4, 4, 1)


def corner_of(room: tuple[int, ...]) -> np.ndarray:
    """(3,) m, of the room's inside; the seen one begins at the origin."""
    return (np.array(room) - SEEN) * (SIZE + WALL)


def lights_of_the_room() -> list[Lamp]:
    """The five that matter."""
    below = (0.0, 0.0, -1.0)
    places = [(1.2, 1.2, 2.8), (4.8, 1.3, 2.7), (3.0, 2.5, 2.9), (1.3, 3.8, 2.6), (4.7, 3.9, 2.8)]
    sizes = [(0.5, 0.5), (0.9, 0.2), (0.6, 0.6), (0.3, 0.3), (0.4, 0.8)]
    shapes = [LightShape.RECTANGLE, LightShape.RECTANGLE, LightShape.ELLIPSE, LightShape.ELLIPSE, LightShape.RECTANGLE]
    return [
        (shape, place, tuple(np.add(place, below) + (0.2, 0.1 * number, 0.0)), size, 25.0, math.pi)
        for number, (shape, place, size) in enumerate(zip(shapes, places, sizes, strict=True))
    ]


def hidden(number: int) -> Lamp:
    """In another room."""
    others = [room for room in np.ndindex(ROOMS) if room != SEEN]
    near = sorted(others, key=lambda room: float(np.abs(corner_of(room)).sum()))[number % len(others)]
    place = corner_of(near) + SIZE * (0.5, 0.4 + 0.2 * (number // len(others)), 0.9)
    return LightShape.RECTANGLE, tuple(place), tuple(place + (0.1, 0.2, -1.0)), (0.5, 0.5), 25.0, math.pi


def turned_away(number: int) -> Lamp:
    """Close under the ceiling, shining at it from where nothing of it is seen: at the wall behind the camera."""
    place = np.array([0.1 + 0.029 * number, 0.02, 2.0])
    return LightShape.RECTANGLE, tuple(place), tuple(place + (0.01, -1.0, 0.0)), (0.02, 0.4), 5.0, math.pi


def elsewhere(number: int) -> Lamp:
    """With a spread too narrow to reach what is seen."""
    angle = 2.4 * number
    place = np.array([3.0 + 2.0 * math.cos(angle), 2.5 + 1.5 * math.sin(angle), 2.95])
    outwards = place + (0.001, 0.002, 1.0)
    return LightShape.ELLIPSE, tuple(place), tuple(outwards), (0.1, 0.1), 10.0, math.radians(30.0)


def faint(number: int) -> Lamp:
    """Among the five, and too weak to be seen: all of them together send less than a thousandth."""
    angle = 2.4 * number
    place = np.array([3.0 + 2.0 * math.cos(angle), 2.5 + 1.5 * math.sin(angle), 2.9])
    return LightShape.RECTANGLE, tuple(place), tuple(place + (0.1, 0.2, -1.0)), (0.2, 0.2), 1e-4, math.pi


#: Why lamps change nothing: how they are made.
IDLE: dict[str, Callable[[int], Lamp]] = {
    "hidden": hidden,
    "turned away": turned_away,
    "elsewhere": elsewhere,
    "faint": faint,
}


def rooms(idle: dict[str, int], width: int = 640, height: int = 360) -> tuple[Scene, View]:
    """The room with the five lamps, and numbers of the others by why they are idle."""
    lamps = lights_of_the_room() + [IDLE[why](number) for why, count in idle.items() for number in range(count)]
    meshes = [
        subdivided_box(np.full(3, -WALL), (SIZE[0], 0.0, SIZE[2]), 8),
        subdivided_box(np.full(3, -WALL), (0.0, SIZE[1], SIZE[2]), 8),
        subdivided_box(np.full(3, -WALL), (SIZE[0], SIZE[1], 0.0), 8),
        sphere((0.0, 0.0, 0.0), 0.4, 60, 40),
        subdivided_box((-0.3, -0.3, 0.0), (0.3, 0.3, 1.1), 6),
    ]
    walls = [(kind, corner_of(room)) for room in np.ndindex(*(np.array(ROOMS) + 1)) for kind in range(3)]
    things = [(3, (2.0, 3.0, 0.4)), (3, (4.1, 2.2, 0.9)), (4, (3.0, 3.8, 0.0)), (4, (4.1, 2.2, -0.6))]
    kinds, places = zip(*walls, *things, strict=True)
    built = scene(meshes, lamps, np.array(kinds), np.array(places))
    return built, view((0.6, 0.4, 1.7), (3.2, 3.0, 0.9), width, height)
