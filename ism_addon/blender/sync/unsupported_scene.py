# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about settings of a scene, its camera and its view layer that this engine does not support."""

import bpy

from .diagnostics import Diagnostics


def warn(depsgraph: bpy.types.Depsgraph, findings: Diagnostics) -> None:
    """Add an issue for each."""
    scene, view_layer = depsgraph.scene_eval, depsgraph.view_layer_eval
    camera = scene.camera
    if camera is not None and camera.type == "CAMERA" and camera.data.dof.use_dof:
        findings.warn("Depth of field is not drawn", camera.name)
    if scene.render.use_motion_blur and view_layer.use_motion_blur:
        findings.warn("Motion blur is not drawn", scene.name)
    if scene.render.use_freestyle and view_layer.use_freestyle:
        findings.warn("Freestyle's lines are not drawn", view_layer.name)
