# SPDX-License-Identifier: GPL-3.0-or-later
"""Glossy surfaces from the side beside Cycles, with bumps so steep that mirrors show what is below the horizon."""

import math

import bpy
import numpy as np
import pytest

from tests.benchmark.files import FILTER_WIDTH, our_render
from tests.demo.figure6 import quiet_stdout
from tests.scenes.cycles import direct_light
from tests.scenes.materials.spheres import material_of
from tests.scenes.worlds import maps
from tests.tables.furnace import Shader, shader

pytestmark = pytest.mark.usefixtures("registered")

SIDE, ELEVATION = 32, math.radians(8.0)
OUR_SAMPLES, SAMPLES = 64, 256
BOUND = 0.02

COLOR = (0.8, 0.4, 0.2)
COAT = {"Base Color": (0.0, 0.0, 0.0), "Specular IOR Level": 0.0, "Coat Weight": 1.0, "Coat Roughness": 0.2}
CASES = {
    "glossy": shader("ShaderNodeBsdfAnisotropic", {}, {"Color": COLOR, "Roughness": 0.2}),
    "metal": shader("ShaderNodeBsdfPrincipled", {}, {"Base Color": COLOR, "Metallic": 1.0, "Roughness": 0.2}),
    "glass": shader("ShaderNodeBsdfGlass", {}, {"Color": COLOR, "Roughness": 0.2}),
    "coat": shader("ShaderNodeBsdfPrincipled", {}, COAT),
    "plastic": shader("ShaderNodeBsdfPrincipled", {}, {"Base Color": COLOR, "Roughness": 0.2}),
}


def bumped(add_shader: Shader) -> Shader:
    """The same shader with bumps."""

    def add(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
        surface = add_shader(tree)
        noise, bump = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeBump")
        noise.inputs["Scale"].default_value, bump.inputs["Distance"].default_value = 6.0, 0.3
        tree.links.new(noise.outputs[0], bump.inputs["Height"])
        for name in {"Normal", "Coat Normal"} & set(surface.node.inputs.keys()):
            tree.links.new(bump.outputs[0], surface.node.inputs[name])
        return surface

    return add


@pytest.fixture
def build(empty_scene, add):
    """A square for each case, in a row, under a sky that is black below the horizon; the camera looks from the side."""
    empty_scene.cycles.light_sampling_threshold = 0.0
    for column, add_shader in enumerate(CASES.values()):
        left = column - 0.5 * len(CASES)
        depth = 0.5 / math.sin(ELEVATION)
        corners = [(left, -depth, 0.0), (left + 1.0, -depth, 0.0), (left + 1.0, depth, 0.0), (left, depth, 0.0)]
        add("square", (corners, [(0, 1, 2, 3)])).data.materials.append(material_of(bumped(add_shader)))
    data = bpy.data.cameras.new("camera")
    data.type, data.ortho_scale = "ORTHO", float(len(CASES))
    empty_scene.camera = add("camera", data)
    empty_scene.camera.location = 0.0, -50.0 * math.cos(ELEVATION), 50.0 * math.sin(ELEVATION)
    empty_scene.camera.rotation_euler = math.pi / 2.0 - ELEVATION, 0.0, 0.0
    render = empty_scene.render
    render.resolution_x, render.resolution_y, render.filter_size = len(CASES) * SIDE, SIDE, FILTER_WIDTH
    empty_scene.world = maps.world_with(maps.overcast(4) * (maps.directions()[..., 2:] > 0.0))


@pytest.mark.parametrize("is_corrected", [True, False])
def test_reflections_are_those_of_cycles(build, is_corrected):
    for material in bpy.data.materials:
        material.cycles.use_bump_map_correction = is_corrected
        material.update_tag()
    with quiet_stdout():
        ours, _ = our_render(OUR_SAMPLES)
        theirs = direct_light(SAMPLES, FILTER_WIDTH)[..., :3]
    means = [picture.reshape(SIDE, len(CASES), SIDE, 3).mean((0, 2)) for picture in (ours, theirs)]
    errors = dict(zip(CASES, np.abs(means[0] / means[1] - 1.0).max(-1).tolist(), strict=True))
    assert max(errors.values()) < BOUND, errors
