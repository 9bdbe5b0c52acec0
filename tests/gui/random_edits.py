# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist may do at any time: edits that take nothing for granted but a session."""

from random import Random

import bpy

from tests.gui import scene_setup
from tests.gui.session import Session


def move(_stage: Session, chance: Random) -> None:
    thing = chance.choice([*bpy.data.objects])
    thing.location = [chance.uniform(-2.0, 2.0), chance.uniform(-2.0, 2.0), chance.uniform(0.5, 4.0)]


def scale(_stage: Session, chance: Random) -> None:
    chance.choice([*bpy.data.objects]).scale = [chance.choice((0.0, 0.5, 1.0, -1.0, 2.0)) for _ in range(3)]


def add(_stage: Session, chance: Random) -> None:
    scene_setup.add(
        "New", chance.choice((scene_setup.ball, scene_setup.cube))(chance.uniform(0.1, 1.0)), (0.0, 0.0, 1.0)
    )


def add_light(_stage: Session, chance: Random) -> None:
    scene_setup.area_light("New", (chance.uniform(-3.0, 3.0), 1.0, 3.0), watts=100.0, size=chance.uniform(0.0, 2.0))


def delete(_stage: Session, chance: Random) -> None:
    bpy.data.objects.remove(chance.choice([*bpy.data.objects])) if len(bpy.data.objects) > 3 else None


def hide(_stage: Session, chance: Random) -> None:
    thing = chance.choice([*bpy.data.objects])
    thing.hide_viewport = not thing.hide_viewport


def duplicate(session: Session, chance: Random) -> None:
    with session.in_viewport():
        bpy.ops.object.select_all(action="DESELECT")
        chance.choice([*session.scene.objects]).select_set(True)
        bpy.ops.object.duplicate()


def recolour(_stage: Session, chance: Random) -> None:
    things = [thing for thing in bpy.data.objects if thing.type == "MESH"]
    if things:
        data = chance.choice(things).data
        data.materials.clear()
        data.materials.append(scene_setup.material("New", (chance.random(), chance.random(), chance.random())))


def edit_mesh(_stage: Session, chance: Random) -> None:
    meshes = [mesh for mesh in bpy.data.meshes if mesh.vertices]
    if meshes:
        mesh = chance.choice(meshes)
        mesh.vertices[0].co.z += chance.uniform(-0.5, 0.5)
        mesh.update()


def empty_mesh(_stage: Session, chance: Random) -> None:
    scene_setup.add("Empty", bpy.data.meshes.new("Empty"))


def occlude(session: Session, chance: Random) -> None:
    session.scene.ism.ssao.radius = chance.uniform(0.0, 3.0)


def change_method(session: Session, chance: Random) -> None:
    session.scene.ism.shadow.method = chance.choice(("RAY_TRACED", "SHADOW_MAPS"))


def turn(session: Session, chance: Random) -> None:
    scene_setup.set_view(session.view, chance.uniform(0.5, 20.0))
    session.view.view_perspective = chance.choice(("PERSP", "ORTHO"))


def change_shading(session: Session, chance: Random) -> None:
    session.space.shading.type = chance.choice(("SOLID", "RENDERED", "RENDERED", "RENDERED"))


def next_frame(session: Session, _chance: Random) -> None:
    session.scene.frame_set(session.scene.frame_current + 1)


def undo(session: Session, _chance: Random) -> None:
    with session.in_viewport():
        if bpy.ops.ed.undo.poll():
            bpy.ops.ed.undo()


def redo(session: Session, _chance: Random) -> None:
    with session.in_viewport():
        if bpy.ops.ed.redo.poll():
            bpy.ops.ed.redo()


EDITS = (
    *(move, scale, add, add_light, delete, hide, duplicate, recolour, edit_mesh, empty_mesh, occlude),
    *(change_method, turn, change_shading, next_frame),
)
STEPS = (undo, redo)
