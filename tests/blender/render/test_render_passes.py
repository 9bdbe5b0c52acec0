# SPDX-License-Identifier: GPL-3.0-or-later
"""A row in the table of render passes is enough to add a pass to Blender: its view layers, and the rendered files."""

import bpy
import numpy as np
import pytest

from ism_addon import render_passes
from ism_addon.blender.sync import camera, scene_reader
from tests.unit.test_render_passes import ADDED, compare, expected

from .test_engine import HEIGHT, WIDTH
from .test_engine import render_channels as render_channels
from .test_engine import scene as scene

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def two_colored_objects(scene):
    """The cube and the floor have different colours; the floor ends within the picture."""
    for name, color in {"Cube": (0.8, 0.1, 0.2, 1.0), "Plane": (0.5, 0.6, 0.7, 1.0)}.items():
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        inputs = material.node_tree.nodes["Principled BSDF"].inputs
        inputs["Base Color"].default_value, inputs["Specular IOR Level"].default_value = color, 0.0
        bpy.data.objects[name].data.materials.append(material)
    bpy.data.objects["Plane"].scale = 0.08, 0.05, 1.0
    bpy.data.objects["Cube"].rotation_euler = 0.4, 0.3, 0.2
    return scene


@pytest.mark.parametrize("enabled", [ADDED, ADDED[:1], ()], ids=["both", "one", "none"])
def test_each_row_is_a_pass_in_blenders_files(two_colored_objects, render_channels, monkeypatch, enabled):
    monkeypatch.setattr(render_passes, "RENDER_PASSES", (*render_passes.RENDER_PASSES, *ADDED))
    for each in enabled:
        setattr(two_colored_objects.view_layers[0], each.switch, True)
    channels = render_channels()
    names = {"Combined", "Depth", "Normal", *(each.name for each in enabled)}
    assert {channel.split(".")[1] for channel in channels} == names
    depsgraph = bpy.context.evaluated_depsgraph_get()
    truth = expected(scene_reader.scene(depsgraph), camera.final_view(depsgraph))
    for each in render_passes.RENDER_PASSES:
        if each.name in names - {"Combined"}:
            image = np.stack([channels[f"Layer.{each.name}.{letter}"] for letter in each.channels], -1)
            assert image.shape[:2] == (HEIGHT, WIDTH)
            compare(image, truth[each.name])


def test_every_switch_is_a_property_of_view_layers(scene):
    """The panel shows it by this name."""
    switches = {each.switch for each in render_passes.RENDER_PASSES if each.switch}
    assert switches <= {*scene.view_layers[0].bl_rna.properties.keys()}
