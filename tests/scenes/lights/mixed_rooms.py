# SPDX-License-Identifier: GPL-3.0-or-later
"""The room of tests/scenes/rooms.py under eight lights of all types, and any number that light nothing in it."""

from dataclasses import fields, replace

import numpy as np

from ism_addon.scene import Lights, LightShape, Scene, View
from tests.scenes.parts.tables import instances_of, materials_of
from tests.scenes.rooms import ROOMS, SIZE, VISIBLE_ROOM, room_corner, rooms
from tests.scenes.small import sphere, subdivided_box

#: Lights of the visible room, besides an emissive panel: type, position, and what else differs from an ordinary one.
LAMPS = (
    (LightShape.RECTANGLE, (1.2, 1.2, 2.8), {}),
    (LightShape.ELLIPSE, (4.8, 1.3, 2.7), {}),
    (LightShape.POINT, (3.0, 2.5, 2.7), {"radius": 0.1}),
    (LightShape.POINT, (1.3, 3.8, 2.5), {}),
    (LightShape.SPOT, (4.7, 3.9, 2.8), {"radius": 0.05, "spread": 1.6, "blend": 0.3}),
    (LightShape.SPOT, (2.0, 1.0, 2.8), {"spread": 1.9, "blend": 1.0}),
    (LightShape.POINT, (5.2, 2.5, 1.6), {"radius": 0.05}),
)
#: The types of idle lights, in turn: in other rooms, suns above the roof, and spots that point into a wall.
IDLE = ("area", "point", "spot", "sun", "turned spot", "emissive")


def lamps(rows: list[tuple[LightShape, tuple[float, ...], dict[str, float]]]) -> Lights:
    """A table of lights that point down, each about as bright as the others."""
    count = len(rows)
    shapes = np.array([shape for shape, *_ in rows])
    size = np.where(shapes <= LightShape.ELLIPSE, 0.4, 1.0)[:, None]
    emission = np.select([shapes <= LightShape.ELLIPSE, shapes == LightShape.SUN], [25.0, 3.0], 4.0)
    values = {
        "shape": shapes,
        "position": [position for _, position, _ in rows],
        "axis_u": size * (1.0, 0.0, 0.0),
        "axis_v": size * (0.0, -1.0, 0.0),
        "normal": [other.get("normal", (0.0, 0.0, -1.0)) for *_, other in rows],
        "emission": emission[:, None] * np.ones(3),
        "soft_falloff": np.zeros(count, bool),
        "casts_shadow": np.ones(count, bool),
        "visible_camera": np.zeros(count, bool),
        "shadow_softness": np.ones(count),
        "falloff_power": np.zeros(count, np.int32),
        "falloff_smooth": np.zeros(count),
        "profile": np.full(count, -1),
        "image": np.full(count, -1),
        "profile_axes": np.zeros((count, 3, 3)),
        "receivers": np.full(count, -1),
        "blockers": np.full(count, -1),
    }
    for name, usual in (("spread", np.pi), ("blend", 0.0), ("radius", 0.0)):
        values[name] = [other.get(name, usual) for *_, other in rows]
    return Lights.of(**{member.name: values[member.name] for member in fields(Lights)})


def mixed_rooms(idle: int, width: int = 640, height: int = 360) -> tuple[Scene, View]:
    """The room with its eight lights, and `idle` further ones."""
    scene, view = rooms({}, width, height)
    others = [room for room in np.ndindex(ROOMS) if room != VISIBLE_ROOM]
    others.sort(key=lambda room: float(np.abs(room_corner(room)).sum()))
    rows, bulbs = list(LAMPS), []
    for index in range(idle):
        kind, place = IDLE[index % len(IDLE)], room_corner(others[index % len(others)]) + SIZE * (0.5, 0.5, 0.85)
        if kind == "emissive":
            bulbs.append(place)
        elif kind == "sun":
            rows.append((LightShape.SUN, (0.0, 0.0, 0.0), {"spread": 0.01 + 0.001 * index}))
        elif kind == "turned spot":
            down = (0.03 + 0.005 * index % 5.9, 0.02, 2.0)
            rows.append((LightShape.SPOT, down, {"spread": 0.5, "radius": 0.02, "normal": (0.0, -1.0, 0.0)}))
        else:
            shape = {"area": LightShape.RECTANGLE, "point": LightShape.POINT, "spot": LightShape.SPOT}[kind]
            rows.append((shape, tuple(place), {"spread": 1.5 if kind == "spot" else np.pi, "radius": 0.05}))
    return with_emitters(replace(scene, lights=lamps(rows)), bulbs), view


def with_emitters(scene: Scene, bulbs: list[np.ndarray]) -> Scene:
    """A scene with an emissive panel in the visible room, and bulbs."""
    emits = [
        replace(mesh, materials=np.ones(len(mesh.triangles), np.uint32))
        for mesh in (subdivided_box((2.6, 4.0, 2.4), (3.4, 4.4, 2.5), 1), sphere((0.0, 0.0, 0.0), 0.1, 16, 8))
    ]
    meshes, old = len(scene.meshes), scene.instances
    matrices = np.tile(np.eye(4), (1 + len(bulbs), 1, 1))
    matrices[1:, :3, 3] = np.reshape(bulbs, (-1, 3))
    return replace(
        scene,
        meshes=(*scene.meshes, *emits),
        instances=instances_of(
            [*old.mesh, meshes, *[meshes + 1] * len(bulbs)], np.concatenate([old.world_from_object, matrices])
        ),
        materials=materials_of([(0.6, 0.6, 0.6), (0.0, 0.0, 0.0)], emission=[(0.0, 0.0, 0.0), (8.0, 7.0, 6.0)]),
    )
