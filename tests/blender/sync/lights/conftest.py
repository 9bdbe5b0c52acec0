# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures for tests of lights: a lamp above a plane."""

import bpy
import pytest


@pytest.fixture
def light_object(add, empty_scene):
    """An area light above a white plane, under a camera that looks down."""
    plane = add("Plane", ([(-6, -6, 0), (6, -6, 0), (6, 6, 0), (-6, 6, 0)], [(0, 1, 2, 3)]))
    white = bpy.data.materials.new("White")
    white.use_nodes = True
    white.node_tree.nodes["Principled BSDF"].inputs["Specular IOR Level"].default_value = 0.0
    plane.data.materials.append(white)
    light = bpy.data.lights.new("Lamp", "AREA")
    light.shape, light.size, light.size_y, light.energy = "RECTANGLE", 2.0, 3.0, 100.0
    light_object = add("Lamp", light)
    light_object.location = 0, 0, 2
    empty_scene.camera = add("Camera", bpy.data.cameras.new("Camera"))
    empty_scene.camera.data.type, empty_scene.camera.data.ortho_scale = "ORTHO", 8.0
    empty_scene.camera.location = 0, 0, 9
    empty_scene.render.resolution_x = empty_scene.render.resolution_y = 16
    return light_object
