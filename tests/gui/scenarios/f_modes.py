# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes changed by animation, modes with brushes, bones, modifiers and instances: the viewport shows each change."""

import math
import time
from collections.abc import Callable

import bpy
import numpy as np
from mathutils import Vector

from tests.gui import scene_setup, updates
from tests.gui.scenario import scenario
from tests.gui.session import Session, Steps

RED = (0.9, 0.05, 0.05)


@scenario(region=(480, 360))
def frames(session: Session) -> Steps:
    """A light and an object are animated: frames are shown when they are set, and in playback."""
    scene_setup.build_studio()
    ball, light = bpy.data.objects["Ball"], bpy.data.objects["Lamp"]
    for frame, location, watts in ((1, (1.0, 0.2, 0.7), 400.0), (60, (0.2, -1.8, 0.7), 100.0)):
        ball.location, light.data.energy = location, watts
        ball.keyframe_insert("location", frame=frame)
        light.data.keyframe_insert("energy", frame=frame)
    session.scene.frame_start, session.scene.frame_end = 1, 60
    session.scene.frame_set(1)
    first = yield from updates.first_picture(session)
    yield from updates.assert_changed(session, "frame 40", lambda: session.scene.frame_set(40), first)
    yield from updates.assert_unchanged(session, "frame 1", lambda: session.scene.frame_set(1), first)
    session.calls.patch_uv = (0.5, 0.3)
    since = time.perf_counter()
    with session.in_viewport():
        bpy.ops.screen.animation_play()
    yield from session.wait(2.0)
    with session.in_viewport():
        bpy.ops.screen.animation_cancel(restore_frame=False)
    colors = {tuple(call.patch_color) for call in session.calls.patch_colors(since)}
    session.calls.patch_uv = None
    session.record("pictures in 2 s of playback", len(colors))
    assert len(colors) > 5, "playback is not shown"
    yield from session.until_idle()
    assert session.scene.frame_current != 1
    stopped = session.pixels("stopped")
    yield from updates.assert_current(session, "stopped", stopped)
    frame = session.scene.frame_current
    yield from updates.assert_changed(session, "frame 1 again", lambda: session.scene.frame_set(1), stopped)
    yield from updates.assert_unchanged(
        session, "the frame where it stopped", lambda: session.scene.frame_set(frame), stopped
    )


@scenario(region=(480, 360))
def modes_with_brushes(session: Session) -> Steps:
    """Sculpting and painting are shown before their modes are left; entering and leaving changes nothing."""
    scene_setup.build_studio()
    ball = bpy.data.objects["Ball"]
    ball.data.materials.append(_paintable_material())
    ball.data.uv_layers.new()
    ball.vertex_groups.new(name="Swollen")
    ball.modifiers.new("Swell", "DISPLACE").vertex_group = "Swollen"
    session.view_layer.objects.active = ball
    brushes = session.scene.tool_settings.unified_paint_settings
    brushes.size, brushes.color, brushes.weight = 20, RED, 0.3
    picture = yield from updates.first_picture(session)
    for mode, (_, edit) in BRUSH_MODES.items():
        yield from _enter(session, mode)
        yield from updates.assert_unchanged(session, f"{mode} entered", lambda: None, picture)
        if edit is not None:
            picture = yield from updates.assert_changed(
                session, f"{mode} used", lambda edit=edit: edit(session), picture
            )
        yield from updates.assert_unchanged(
            session, f"{mode} left", lambda: bpy.ops.object.mode_set(mode="OBJECT"), picture
        )


@scenario(region=(480, 360))
def bones_and_hair(session: Session) -> Steps:
    """A bone is rotated in Pose Mode, and the mesh it deforms is shown; Particle Edit changes nothing."""
    scene_setup.build_studio()
    rig, cube, ball = _add_rig(session), bpy.data.objects["Cube"], bpy.data.objects["Ball"]
    cube.vertex_groups.new(name="Bone").add(range(len(cube.data.vertices)), 1.0, "REPLACE")
    cube.modifiers.new("Bones", "ARMATURE").object = rig
    ball.modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system.settings.type = "HAIR"
    first = yield from updates.first_picture(session)
    yield from updates.assert_unchanged(
        session, "Pose Mode entered", lambda: bpy.ops.object.mode_set(mode="POSE"), first
    )
    rotate = lambda: setattr(rig.pose.bones["Bone"], "rotation_euler", (0.0, 0.8, 0.0))  # noqa: E731
    posed = yield from updates.assert_changed(session, "bone turned", rotate, first)
    yield from updates.assert_unchanged(
        session, "Pose Mode left", lambda: bpy.ops.object.mode_set(mode="OBJECT"), posed
    )
    session.view_layer.objects.active = ball
    yield from updates.assert_unchanged(session, "Particle Edit entered", _enter_particle_edit, posed)
    yield from updates.assert_unchanged(session, "Particle Edit left", bpy.ops.particle.particle_edit_toggle, posed)


@scenario(region=(480, 360))
def modifiers_and_instances(session: Session) -> Steps:
    """Modifiers, instances and texts change, and so do the meshes that they are made of."""
    scene_setup.build_studio()
    cube = bpy.data.objects["Cube"]
    group = scene_setup.move_to_collection("Group", bpy.data.objects["Ball"])
    bpy.data.objects["Ball"].location = (0.0, 0.0, 0.7)
    holder = scene_setup.add_object("Holder", None, (1.0, 0.2, 0.0))
    holder.instance_type, holder.instance_collection = "COLLECTION", group
    picture = yield from updates.first_picture(session)
    smooth, array = (cube.modifiers.new(type_, type_) for type_ in ("SUBSURF", "ARRAY"))
    array.relative_offset_displace = (-0.9, 0.5, 0.0)
    row = scene_setup.add_object("Row", bpy.data.meshes.new("Nothing"), (-2.5, -1.6, 0.2))
    row.modifiers.new("Row", "NODES").node_group = nodes = _row_nodes(scene_setup.cube(0.4))
    _set_count(row, 2)
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.extrude = "one", 0.1
    scene_setup.add_object("Text", text, (-1.0, -2.6, 0.0)).rotation_euler = scene_setup.VIEW_ROTATION
    actions = {
        "made": lambda: None,
        "subdivision level": lambda: setattr(smooth, "levels", 3),
        "array count": lambda: setattr(array, "count", 3),
        "collection's instance moved": lambda: setattr(holder, "location", (1.5, -0.8, 0.0)),
        "mesh in the collection edited": lambda: scene_setup.stretch(bpy.data.meshes["Ball"]),
        "object in the collection moved": lambda: setattr(bpy.data.objects["Ball"], "location", (0.0, 1.0, 0.7)),
        "object added to the collection": lambda: group.objects.link(
            scene_setup.add_object("More", scene_setup.cube(0.5))
        ),
        "more of the nodes' instances": lambda: _set_count(row, 6),
        "the nodes' instances lengthened": lambda: _lengthen_instances(nodes),
        "text typed": lambda: setattr(text, "body", "two three"),
        "text thickened": lambda: setattr(text, "extrude", 0.5),
    }
    for name, action in actions.items():
        picture = yield from updates.assert_changed(session, name, action, picture)


def _enter_particle_edit() -> None:
    bpy.ops.particle.particle_edit_toggle()
    bpy.ops.wm.tool_set_by_id(name="builtin.select_box")  # a tool without a brush to draw


def _enter(session: Session, mode: str) -> Steps:
    """Switch to a mode, with an invisible brush of our own, because some Blenders have none."""
    brush = bpy.data.brushes.new(mode, mode=mode)
    brush.strength = 1.0
    brush.asset_mark()
    with session.in_viewport():
        bpy.ops.object.mode_set(mode=mode)
        bpy.ops.brush.asset_activate(asset_library_type="LOCAL", relative_asset_identifier=f"Brush/{mode}")
    getattr(session.scene.tool_settings, BRUSH_MODES[mode][0]).show_brush = False
    yield from session.main_loop()
    session.space.show_region_asset_shelf = False


def _stroke(session: Session, operator: Callable) -> None:
    """Draw a stroke from left to right over the side of the ball that faces the view."""
    stroke = []
    for x in np.linspace(-0.5, 0.5, 20):
        location = session.view.view_rotation @ Vector((x, 0.0, math.sqrt(0.49 - x * x)))
        u, v = session.region_uv(bpy.data.objects["Ball"].location + location)
        mouse = u * session.region.width, v * session.region.height
        pen = {"pressure": 1.0, "size": 20.0, "pen_flip": False, "x_tilt": 0.0, "y_tilt": 0.0}
        point = {"location": location, "mouse": mouse, "mouse_event": mouse, "time": x}
        stroke.append({"name": "", **point, **pen, "is_start": not stroke})
    operator(stroke=stroke)


#: Modes in which a mesh is edited with brushes: the name of their tool settings, and an edit.
BRUSH_MODES: dict[str, tuple[str, Callable[[Session], object] | None]] = {
    "SCULPT": ("sculpt", lambda session: _stroke(session, bpy.ops.sculpt.brush_stroke)),
    "WEIGHT_PAINT": ("weight_paint", lambda _session: bpy.ops.paint.weight_set()),
    "VERTEX_PAINT": ("vertex_paint", None),
    "TEXTURE_PAINT": ("image_paint", lambda session: _stroke(session, bpy.ops.paint.image_paint)),
}


def _paintable_material() -> bpy.types.Material:
    """A material with an image as its colour, to paint on."""
    material = scene_setup.new_material("Painted", (1.0, 1.0, 1.0))
    tree = material.node_tree
    texture = tree.nodes.active = tree.nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.new("Painted", 64, 64)
    texture.image.generated_color = (0.8, 0.8, 0.8, 1.0)
    tree.links.new(texture.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    return material


def _add_rig(session: Session) -> bpy.types.Object:
    """An active armature with one upright bone in the middle of the scene."""
    rig = scene_setup.add_object("Rig", bpy.data.armatures.new("Rig"))
    session.view_layer.objects.active = rig
    with session.in_viewport():
        bpy.ops.object.mode_set(mode="EDIT")
        rig.data.edit_bones.new("Bone").tail = (0.0, 0.0, 1.0)
        bpy.ops.object.mode_set(mode="OBJECT")
    rig.pose.bones["Bone"].rotation_mode = "XYZ"
    return rig


def _row_nodes(mesh: bpy.types.Mesh) -> bpy.types.NodeTree:
    """Geometry nodes that make instances of a mesh along a line; the input Count is their number."""
    obj = scene_setup.add_object("Pattern", mesh)
    obj.hide_viewport = True
    tree = bpy.data.node_groups.new("Row", "GeometryNodeTree")
    tree.interface.new_socket("Count", in_out="INPUT", socket_type="NodeSocketInt")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    types = "NodeGroupInput", "GeometryNodeMeshLine", "GeometryNodeObjectInfo", "GeometryNodeInstanceOnPoints"
    inputs, line, info, instances, outputs = (tree.nodes.new(type_) for type_ in (*types, "NodeGroupOutput"))
    line.inputs["Offset"].default_value = (0.6, 0.0, 0.0)
    info.inputs["Object"].default_value = obj
    info.inputs["As Instance"].default_value = True
    tree.links.new(inputs.outputs["Count"], line.inputs["Count"])
    tree.links.new(line.outputs["Mesh"], instances.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], instances.inputs["Instance"])
    tree.links.new(instances.outputs["Instances"], outputs.inputs["Geometry"])
    return tree


def _lengthen_instances(tree: bpy.types.NodeTree) -> None:
    tree.nodes["Instance on Points"].inputs["Scale"].default_value = (1.0, 1.0, 4.0)


def _set_count(row: bpy.types.Object, count: int) -> None:
    """Set the nodes' input Count, in the modifier."""
    modifier = row.modifiers["Row"]
    modifier[modifier.node_group.interface.items_tree["Count"].identifier] = count
    row.update_tag()
