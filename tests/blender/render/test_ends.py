# SPDX-License-Identifier: GPL-3.0-or-later
"""What a final render tells of its end: how far it is from it, what ended it, and budgets that are not obeyed."""

import re

import bpy
import pytest

from ism_addon import setting_limits
from ism_addon.blender import engine
from tests.tools.new_file import open_factory_file

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def scene():
    """The factory scene under an area light."""
    scene = open_factory_file()
    scene.objects["Light"].data.type = "AREA"
    scene.render.engine = "ISM"
    scene.render.resolution_x, scene.render.resolution_y = 48, 32
    return scene


@pytest.fixture
def told(scene):
    """Renders, and gives what Blender's status line said on the way."""

    def told() -> str:
        lines = []
        listener = lambda line, *_: lines.append(line)  # noqa: E731 - handlers are told apart
        bpy.app.handlers.render_stats.append(listener)
        try:
            bpy.ops.render.render()
        finally:
            bpy.app.handlers.render_stats.remove(listener)
        return "\n".join(lines)

    return told


def test_a_small_error_ends_it_and_the_status_says_how_small(scene, told):
    scene.ism.render.samples, scene.ism.render.error_threshold = 65536, 0.5
    said = told()
    statistics = engine.statistics()
    assert statistics["stopped_by"] == "error"
    assert f"Sample {statistics['samples']}/65536, error {100.0 * statistics['error']:.1f} %" in said


def test_the_status_counts_shaders_while_they_are_compiled(scene, told):
    """By a thread that has compiled none; a later render of the same scene needs no more."""
    engine.stop()
    first, later = told(), told()
    counted = [int(number) for number in re.findall(r"Compiling shaders \((\d+)\)", first)]
    assert counted
    assert counted == sorted(counted)
    assert "Compiling" not in later


def test_time_ends_it(scene, told):
    scene.ism.render.samples, scene.ism.render.time_limit = 65536, 0.001
    told()
    assert (engine.statistics()["stopped_by"], engine.statistics()["samples"]) == ("time", 1)


def test_a_file_that_asks_for_what_cannot_be_is_told_so(scene, told, capfd):
    """Blender keeps properties in their ranges, but not what scripts and older files have put in their place."""
    scene.ism.render["samples"], scene.ism.render["virtual_lights"] = 0, 10**6
    told()
    assert engine.statistics()["samples"] == 1
    warnings = re.findall(r"(?:Samples|Virtual Point Lights) cannot be .*", capfd.readouterr().out)
    assert sorted(warnings) == [
        "Samples cannot be 0: 1 is used instead.",
        "Virtual Point Lights cannot be 1,000,000: 4,096 is used instead.",
    ]


def test_images_that_are_drawn_smaller_are_told(scene, told, capfd, monkeypatch):
    tree = scene.objects["Cube"].data.materials[0].node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("Picture", 256, 256)
    tree.links.new(node.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    monkeypatch.setattr(setting_limits, "MAX_TEXTURE_LINES", 3)
    told()
    assert "some not drawn at their size: 1 of 256×256 px at 1/2 of it." in capfd.readouterr().out
