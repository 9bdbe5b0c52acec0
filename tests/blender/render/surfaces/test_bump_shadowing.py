# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bump's normal takes away of a low sun's light, and of a lamp's, beside Cycles."""

import math

import bpy
import numpy as np
import pytest

from tests.benchmark.files import FILTER_WIDTH, our_render
from tests.demo.figure6 import quiet_stdout
from tests.scenes.cycles import direct_light
from tests.scenes.materials.spheres import material_of
from tests.tables.furnace import Shader, shader

pytestmark = pytest.mark.usefixtures("registered")

SIDE = 8
WHITE = (1.0, 1.0, 1.0)
CASES = {
    "diffuse": shader("ShaderNodeBsdfDiffuse", {}, {"Color": WHITE}),
    "rough diffuse": shader("ShaderNodeBsdfDiffuse", {}, {"Color": WHITE, "Roughness": 0.8}),
    "glossy": shader("ShaderNodeBsdfAnisotropic", {}, {"Color": WHITE, "Roughness": 1.0}),
    "sheen": shader("ShaderNodeBsdfSheen", {}, {"Color": WHITE, "Roughness": 0.7}),
}
LAMPS = {"SUN": (math.pi, 0.0), "AREA": (100.0, 1.0)}  # strengths, and angles or sizes


def tilted(add_shader: Shader, degrees: float) -> Shader:
    """The same shader with a normal that is turned to +x."""

    def add(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
        surface, normal = add_shader(tree), tree.nodes.new("ShaderNodeCombineXYZ")
        angle = math.radians(degrees)
        normal.inputs[0].default_value, normal.inputs[2].default_value = math.sin(angle), math.cos(angle)
        tree.links.new(normal.outputs[0], surface.node.inputs["Normal"])
        return surface

    return add


@pytest.fixture
def build(empty_scene, add):
    """A square for each case, in a row along y, seen from above."""
    for row, add_shader in enumerate(CASES.values()):
        low = row - 0.5 * len(CASES)
        corners = [(-0.5, low, 0.0), (0.5, low, 0.0), (0.5, low + 1.0, 0.0), (-0.5, low + 1.0, 0.0)]
        add("square", (corners, [(0, 1, 2, 3)])).data.materials.append(material_of(tilted(add_shader, 45.0)))
    data = bpy.data.cameras.new("camera")
    data.type, data.ortho_scale = "ORTHO", float(len(CASES))
    empty_scene.camera = add("camera", data)
    empty_scene.camera.location = 0.0, 0.0, 5.0
    render = empty_scene.render
    render.resolution_x, render.resolution_y, render.filter_size = SIDE, SIDE * len(CASES), FILTER_WIDTH
    empty_scene.cycles.light_sampling_threshold = 0.0


@pytest.mark.parametrize("is_corrected", [True, False])
@pytest.mark.parametrize("elevation", [15.0, 60.0])
@pytest.mark.parametrize("kind", LAMPS)
def test_bumps_are_shadowed_as_in_cycles(build, add, kind, elevation, is_corrected):
    for material in bpy.data.materials:
        material.cycles.use_bump_map_correction = is_corrected
        material.update_tag()
    data = bpy.data.lights.new("lamp", kind)
    data.energy, size = LAMPS[kind]
    setattr(data, "angle" if kind == "SUN" else "size", size)
    lamp, angle = add("lamp", data), math.radians(90.0 - elevation)
    lamp.location = 3.0 * math.sin(angle), 0.0, 3.0 * math.cos(angle)
    lamp.rotation_euler = 0.0, angle, 0.0
    with quiet_stdout():
        ours, _ = our_render(256)
        theirs = direct_light(4 if kind == "SUN" else 256, FILTER_WIDTH)[..., :3]
    inner = slice(2, SIDE - 2)
    means = [picture.reshape(len(CASES), SIDE, SIDE, 3)[:, inner, inner].mean((1, 2, 3)) for picture in (ours, theirs)]
    errors = dict(zip(CASES, np.abs(means[0] / means[1] - 1.0).tolist(), strict=True))
    assert max(errors.values()) < 0.003, errors
