# SPDX-License-Identifier: GPL-3.0-or-later
"""Unshadowed light against Cycles: every shape, under scale and spread, to the watt."""

import math
from dataclasses import replace

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync import camera, scene_reader
from ism_addon.gpu.renderer import Profile, Renderer
from ism_addon.settings import SSAO, Quality, Settings, Shadow
from tests.scenes.cycles import PIXEL_CENTRES, direct_light

SIDE, BLOCK = 64, 8
SPREADS = {"plain": math.pi, "wide": math.radians(120.0), "narrow": math.radians(40.0)}
#: Cycles' samples, most for round narrow lights, of which it hits only a part: its noise is below half of the bounds.
SAMPLES = {"plain": 64, "wide": 64, "narrow": 384}
#: Relative error of a block: the median, and what nine of ten keep.
BOUNDS = {"plain": (0.0002, 0.0005), "wide": (0.0003, 0.001), "narrow": (0.003, 0.008)}


@pytest.fixture
def lamp_over_plane(empty_scene, add):
    """lamp_over_plane(shape, spread): a tilted, scaled lamp above a white plane, seen from above."""

    def build(shape: str, spread: float) -> None:
        plane = add("plane", ([(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)], [(0, 1, 2, 3)]))
        white = bpy.data.materials.new("white")
        white.use_nodes = True
        principled = white.node_tree.nodes["Principled BSDF"]
        principled.inputs["Base Color"].default_value = (0.8, 0.6, 0.4, 1.0)
        principled.inputs["Specular IOR Level"].default_value = 0.0
        plane.data.materials.append(white)
        light = bpy.data.lights.new("lamp", "AREA")
        light.shape, light.size, light.size_y, light.spread, light.energy = shape, 1.0, 0.5, spread, 50.0
        lamp = add("lamp", light)
        lamp.location, lamp.rotation_euler, lamp.scale = (0.4, 0.2, 1.5), (0.3, 0.2, 0.5), (1.4, 0.8, 1.0)
        lamp.visible_camera = False
        data = bpy.data.cameras.new("camera")
        data.lens = 30.0
        empty_scene.camera = add("camera", data)
        empty_scene.camera.location = (0.0, 0.0, 3.5)
        empty_scene.render.resolution_x = empty_scene.render.resolution_y = SIDE

    return build


@pytest.mark.parametrize("spread", SPREADS)
@pytest.mark.parametrize("shape", ["SQUARE", "RECTANGLE", "DISK", "ELLIPSE"])
def test_unshadowed_light_is_that_of_cycles(device, lamp_over_plane, shape, spread):
    lamp_over_plane(shape, SPREADS[spread])
    depsgraph = bpy.context.evaluated_depsgraph_get()
    scene = scene_reader.scene(depsgraph)
    view = replace(camera.final_view(depsgraph), filter_width=PIXEL_CENTRES)  # as the truth
    renderer = Renderer(device)
    settings = Settings(
        shadow=Shadow(enabled=False), ssao=SSAO(enabled=False), quality=Quality(samples=1, virtual_lights=4)
    )
    for _ in renderer.sample(scene, view, settings, 0, Profile()):
        pass
    ours, theirs = renderer.picture()[..., :3], direct_light(SAMPLES[spread])[..., :3]
    renderer.release()
    blocks = np.median(
        [np.reshape(p, (SIDE // BLOCK, BLOCK, SIDE // BLOCK, BLOCK, 3)).mean((1, 3)) for p in (ours, theirs)], -1
    )
    lit = blocks[1] > 0.05 * blocks[1].max()
    error = np.abs(blocks[0] / np.where(lit, blocks[1], 1.0) - 1.0)[lit]
    assert lit.sum() >= 8
    median, most = BOUNDS[spread]
    assert np.median(error) < median and np.quantile(error, 0.9) < most
