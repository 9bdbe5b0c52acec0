# SPDX-License-Identifier: GPL-3.0-or-later
"""A place that worlds light."""

from types import SimpleNamespace

import bpy
import pytest

from tests.benchmark.files import FILTER_WIDTH


@pytest.fixture
def place(add, empty_scene):
    """A ball and a block on a floor, seen from above."""
    floor = add("Floor", ([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [(0, 1, 2, 3)]))
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.0, location=(0, 0, 1), segments=48, ring_count=24)
    ball = bpy.context.object
    ball.data.shade_smooth()
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(1.9, 0.4, 0.5))
    block = bpy.context.object
    camera = empty_scene.camera = add("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler, camera.data.lens = (2.5, -5.0, 4.0), (0.93, 0.0, 0.43), 32.0
    render = empty_scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 96, 64, 100
    render.filter_size = FILTER_WIDTH
    return SimpleNamespace(scene=empty_scene, floor=floor, ball=ball, block=block)
