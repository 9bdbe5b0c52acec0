# SPDX-License-Identifier: GPL-3.0-or-later
"""Random edits that an artist may make at any time, whatever the scene holds."""

from random import Random

import bpy

from tests.gui import scene_setup
from tests.gui.session import Session


def move(_session: Session, rng: Random) -> None:
    obj = rng.choice([*bpy.data.objects])
    obj.location = [rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0), rng.uniform(0.5, 4.0)]


def scale(_session: Session, rng: Random) -> None:
    rng.choice([*bpy.data.objects]).scale = [rng.choice((0.0, 0.5, 1.0, -1.0, 2.0)) for _ in range(3)]


def add_mesh(_session: Session, rng: Random) -> None:
    scene_setup.add_object(
        "New", rng.choice((scene_setup.ball, scene_setup.cube))(rng.uniform(0.1, 1.0)), (0.0, 0.0, 1.0)
    )


def add_light(_session: Session, rng: Random) -> None:
    scene_setup.add_area_light("New", (rng.uniform(-3.0, 3.0), 1.0, 3.0), watts=100.0, size=rng.uniform(0.0, 2.0))


def delete(_session: Session, rng: Random) -> None:
    bpy.data.objects.remove(rng.choice([*bpy.data.objects])) if len(bpy.data.objects) > 3 else None


def hide(_session: Session, rng: Random) -> None:
    obj = rng.choice([*bpy.data.objects])
    obj.hide_viewport = not obj.hide_viewport


def duplicate(session: Session, rng: Random) -> None:
    with session.in_viewport():
        bpy.ops.object.select_all(action="DESELECT")
        rng.choice([*session.scene.objects]).select_set(True)
        bpy.ops.object.duplicate()


def recolor(_session: Session, rng: Random) -> None:
    meshes = [obj for obj in bpy.data.objects if obj.type == "MESH"]
    if meshes:
        data = rng.choice(meshes).data
        data.materials.clear()
        data.materials.append(scene_setup.new_material("New", (rng.random(), rng.random(), rng.random())))


def edit_mesh(_session: Session, rng: Random) -> None:
    meshes = [mesh for mesh in bpy.data.meshes if mesh.vertices]
    if meshes:
        mesh = rng.choice(meshes)
        mesh.vertices[0].co.z += rng.uniform(-0.5, 0.5)
        mesh.update()


def add_empty_mesh(_session: Session, rng: Random) -> None:
    scene_setup.add_object("Empty", bpy.data.meshes.new("Empty"))


def change_occlusion(session: Session, rng: Random) -> None:
    session.scene.ism.ssao.radius = rng.uniform(0.0, 3.0)


def change_method(session: Session, rng: Random) -> None:
    session.scene.ism.shadow.method = rng.choice(("RAY_TRACED", "SHADOW_MAPS"))


def change_view(session: Session, rng: Random) -> None:
    scene_setup.set_view(session.view, rng.uniform(0.5, 20.0))
    session.view.view_perspective = rng.choice(("PERSP", "ORTHO"))


def change_shading(session: Session, rng: Random) -> None:
    session.space.shading.type = rng.choice(("SOLID", "RENDERED", "RENDERED", "RENDERED"))


def next_frame(session: Session, _rng: Random) -> None:
    session.scene.frame_set(session.scene.frame_current + 1)


def undo(session: Session, _rng: Random) -> None:
    with session.in_viewport():
        if bpy.ops.ed.undo.poll():
            bpy.ops.ed.undo()


def redo(session: Session, _rng: Random) -> None:
    with session.in_viewport():
        if bpy.ops.ed.redo.poll():
            bpy.ops.ed.redo()


EDITS = (
    *(move, scale, add_mesh, add_light, delete, hide, duplicate, recolor, edit_mesh, add_empty_mesh, change_occlusion),
    *(change_method, change_view, change_shading, next_frame),
)
UNDO_AND_REDO = (undo, redo)
