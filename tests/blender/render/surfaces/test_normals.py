# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals of meshes with sharp edges beside Cycles: where smooth edges do not have two faces that agree."""

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync import camera, scene_reader
from ism_addon.gpu.renderer import Profile, Renderer
from ism_addon.settings import SSAO, Quality, Settings, Shadow
from tests.scenes.cycles import PIXEL_CENTRES, direct_light

SIDE = 48
SETTINGS = Settings(quality=Quality(samples=4, error_threshold=0.0), ssao=SSAO(enabled=False), shadow=Shadow(False))

#: Vertices and faces of roofs around the middle of their ridge, and a flat square beside them.
RIDGE = [(0, -1, 0.5), (0, 1, 0.5), (-1, -1, 0), (-1, 1, 0), (1, -1, 0), (1, 1, 0)]
SQUARE, SQUARE_FACE = [(1.2, -1, 0), (2, -1, 0), (2, 1, 0), (1.2, 1, 0)], (6, 7, 8, 9)
LEFT, RIGHT = (0, 1, 3, 2), (1, 0, 4, 5)
MESHES = {
    "two faces": (RIDGE + SQUARE, [LEFT, RIGHT, SQUARE_FACE]),
    "opposite faces": (RIDGE + SQUARE, [LEFT, RIGHT[::-1], SQUARE_FACE]),
    "three faces": (RIDGE + SQUARE + [(-0.2, -1, 1.5), (-0.2, 1, 1.5)], [LEFT, RIGHT, SQUARE_FACE, (0, 1, 11, 10)]),
    "faces that touch at a vertex": ([*RIDGE, (-1, 1, 0.8)], [(0, 3, 2), (0, 4, 5), (0, 1, 6)]),
}


@pytest.fixture
def build(empty_scene, add):
    """build(name): a smooth mesh of MESHES with a sharp edge below a sun and a camera."""

    def made(name: str) -> None:
        vertices, faces = MESHES[name]
        shape = add("shape", (vertices, faces))
        shape.data.shade_smooth()
        sharp = shape.data.attributes.new("sharp_edge", "BOOLEAN", "EDGE")
        sharp.data[shape.data.edge_keys.index(tuple(sorted(faces[-1][1:3])))].value = True
        lamp = bpy.data.lights.new("lamp", "SUN")
        lamp.energy = 3.0
        add("lamp", lamp).rotation_euler = 0.3, 0.5, 0.0
        data = bpy.data.cameras.new("camera")
        data.type, data.ortho_scale = "ORTHO", 4.4
        empty_scene.camera = add("camera", data)
        empty_scene.camera.location = 0.4, 0.0, 5.0
        empty_scene.render.resolution_x = empty_scene.render.resolution_y = SIDE
        empty_scene.render.filter_size = PIXEL_CENTRES
        for each in bpy.data.objects:
            each.visible_shadow = False

    return made


@pytest.mark.parametrize("name", MESHES)
def test_normals_are_those_of_cycles(device, build, name):
    build(name)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    scene, view, renderer = scene_reader.scene(depsgraph), camera.final_view(depsgraph), Renderer(device)
    for sample in range(SETTINGS.quality.samples):
        for _ in renderer.sample(scene, view, SETTINGS, sample, Profile()):
            pass
    picture, truth = renderer.picture()[..., :3], direct_light(16)[..., :3]
    assert truth.mean() > 0.1
    assert np.median(np.abs(picture - truth)) < 0.001
    assert np.quantile(np.abs(picture - truth), 0.95) < 0.02
