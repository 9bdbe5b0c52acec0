# SPDX-License-Identifier: GPL-3.0-or-later
"""A row of the table of render passes is all that Blender needs: it asks for the pass, and files have its values."""

import bpy
import numpy as np
import pytest

from ism_addon import render_passes
from ism_addon.blender.sync import camera, scene_reader
from tests.pictures.test_render_passes import ADDED, compare, expected

from .test_engine import HEIGHT, WIDTH
from .test_engine import rendered as rendered
from .test_engine import scene as scene

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def of_two_colours(scene):
    """The cube and the floor each have a colour; the floor ends within the picture."""
    for name, color in {"Cube": (0.8, 0.1, 0.2, 1.0), "Plane": (0.5, 0.6, 0.7, 1.0)}.items():
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = color
        bpy.data.objects[name].data.materials.append(material)
    bpy.data.objects["Plane"].scale = 0.08, 0.05, 1.0
    bpy.data.objects["Cube"].rotation_euler = 0.4, 0.3, 0.2
    return scene


@pytest.mark.parametrize("asked", [ADDED, ADDED[:1], ()], ids=["both", "one", "none"])
def test_a_row_is_a_pass_in_blenders_files(of_two_colours, rendered, monkeypatch, asked):
    monkeypatch.setattr(render_passes, "RENDER_PASSES", (*render_passes.RENDER_PASSES, *ADDED))
    for each in asked:
        setattr(of_two_colours.view_layers[0], each.switch, True)
    channels = rendered()
    names = {"Combined", "Depth", "Normal", *(each.name for each in asked)}
    assert {channel.split(".")[1] for channel in channels} == names
    depsgraph = bpy.context.evaluated_depsgraph_get()
    truth = expected(scene_reader.scene(depsgraph), camera.final_view(depsgraph))
    for each in render_passes.RENDER_PASSES:
        if each.name in names - {"Combined"}:
            image = np.stack([channels[f"Layer.{each.name}.{letter}"] for letter in each.channels], -1)
            assert image.shape[:2] == (HEIGHT, WIDTH)
            compare(image, truth[each.name])


def test_every_switch_is_a_view_layers(scene):
    """Which the panel shows by its name."""
    switches = {each.switch for each in render_passes.RENDER_PASSES if each.switch}
    assert switches <= {*scene.view_layers[0].bl_rna.properties.keys()}
