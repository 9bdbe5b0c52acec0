# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene, its camera and its view layer ask for that this engine does not draw."""

import bpy

from .diagnostics import Diagnostics


def note(depsgraph: bpy.types.Depsgraph, findings: Diagnostics) -> None:
    """A sentence for each."""
    scene, view_layer = depsgraph.scene_eval, depsgraph.view_layer_eval
    camera = scene.camera
    if camera is not None and camera.type == "CAMERA" and camera.data.dof.use_dof:
        findings.note("Depth of field is not drawn", camera.name)
    if scene.render.use_motion_blur and view_layer.use_motion_blur:
        findings.note("Motion blur is not drawn", scene.name)
    if scene.render.use_freestyle and view_layer.use_freestyle:
        findings.note("Freestyle's lines are not drawn", view_layer.name)
