# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist may do at any time: edits that take nothing for granted but a stage."""

from random import Random

import bpy

from tests.gui import scenery
from tests.gui.stage import Stage


def move(_stage: Stage, chance: Random) -> None:
    thing = chance.choice([*bpy.data.objects])
    thing.location = [chance.uniform(-2.0, 2.0), chance.uniform(-2.0, 2.0), chance.uniform(0.5, 4.0)]


def scale(_stage: Stage, chance: Random) -> None:
    chance.choice([*bpy.data.objects]).scale = [chance.choice((0.0, 0.5, 1.0, -1.0, 2.0)) for _ in range(3)]


def add(_stage: Stage, chance: Random) -> None:
    scenery.add("New", chance.choice((scenery.ball, scenery.cube))(chance.uniform(0.1, 1.0)), (0.0, 0.0, 1.0))


def add_light(_stage: Stage, chance: Random) -> None:
    scenery.lamp("New", (chance.uniform(-3.0, 3.0), 1.0, 3.0), watts=100.0, size=chance.uniform(0.0, 2.0))


def delete(_stage: Stage, chance: Random) -> None:
    bpy.data.objects.remove(chance.choice([*bpy.data.objects])) if len(bpy.data.objects) > 3 else None


def hide(_stage: Stage, chance: Random) -> None:
    thing = chance.choice([*bpy.data.objects])
    thing.hide_viewport = not thing.hide_viewport


def duplicate(stage: Stage, chance: Random) -> None:
    with stage.in_viewport():
        bpy.ops.object.select_all(action="DESELECT")
        chance.choice([*stage.scene.objects]).select_set(True)
        bpy.ops.object.duplicate()


def recolour(_stage: Stage, chance: Random) -> None:
    things = [thing for thing in bpy.data.objects if thing.type == "MESH"]
    if things:
        data = chance.choice(things).data
        data.materials.clear()
        data.materials.append(scenery.material("New", (chance.random(), chance.random(), chance.random())))


def edit_mesh(_stage: Stage, chance: Random) -> None:
    meshes = [mesh for mesh in bpy.data.meshes if mesh.vertices]
    if meshes:
        mesh = chance.choice(meshes)
        mesh.vertices[0].co.z += chance.uniform(-0.5, 0.5)
        mesh.update()


def empty_mesh(_stage: Stage, chance: Random) -> None:
    scenery.add("Empty", bpy.data.meshes.new("Empty"))


def occlude(stage: Stage, chance: Random) -> None:
    stage.scene.ism.ssao.radius = chance.uniform(0.0, 3.0)


def change_method(stage: Stage, chance: Random) -> None:
    stage.scene.ism.shadow.method = chance.choice(("RAY_TRACED", "SHADOW_MAPS"))


def turn(stage: Stage, chance: Random) -> None:
    scenery.look(stage.view, chance.uniform(0.5, 20.0))
    stage.view.view_perspective = chance.choice(("PERSP", "ORTHO"))


def change_shading(stage: Stage, chance: Random) -> None:
    stage.space.shading.type = chance.choice(("SOLID", "RENDERED", "RENDERED", "RENDERED"))


def next_frame(stage: Stage, _chance: Random) -> None:
    stage.scene.frame_set(stage.scene.frame_current + 1)


def undo(stage: Stage, _chance: Random) -> None:
    with stage.in_viewport():
        if bpy.ops.ed.undo.poll():
            bpy.ops.ed.undo()


def redo(stage: Stage, _chance: Random) -> None:
    with stage.in_viewport():
        if bpy.ops.ed.redo.poll():
            bpy.ops.ed.redo()


EDITS = (
    *(move, scale, add, add_light, delete, hide, duplicate, recolour, edit_mesh, empty_mesh, occlude),
    *(change_method, turn, change_shading, next_frame),
)
STEPS = (undo, redo)
