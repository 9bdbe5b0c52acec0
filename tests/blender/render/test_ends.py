# SPDX-License-Identifier: GPL-3.0-or-later
"""What stops a final render, its status line, and warnings about settings out of range and reduced images."""

import re

import bpy
import pytest

from ism_addon import setting_limits
from ism_addon.blender import engine
from tests.scenes.parts.node_tree import world_of
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
def render_and_log(scene):
    """render_and_log(): renders, and returns what Blender's status line showed meanwhile."""

    def render_and_log() -> str:
        lines = []
        listener = lambda line, *_: lines.append(line)  # noqa: E731 - remove() needs the object that was appended
        bpy.app.handlers.render_stats.append(listener)
        try:
            bpy.ops.render.render()
        finally:
            bpy.app.handlers.render_stats.remove(listener)
        return "\n".join(lines)

    return render_and_log


def test_the_error_threshold_stops_a_render_and_the_status_shows_the_error(scene, render_and_log):
    scene.ism.render.samples, scene.ism.render.error_threshold = 65536, 0.5
    log = render_and_log()
    statistics = engine.statistics()
    assert statistics["stopped_by"] == "error"
    assert f"Sample {statistics['samples']}/65536, error {100.0 * statistics['error']:.1f} %" in log


def test_the_status_counts_shaders_while_they_are_compiled(scene, render_and_log):
    """The first render starts a thread that has compiled no shaders. The second one needs no further shaders."""
    engine.stop()
    first, later = render_and_log(), render_and_log()
    counted = [int(count) for count in re.findall(r"Compiling shaders \((\d+)\)", first)]
    assert counted
    assert counted == sorted(counted)
    assert "Compiling" not in later


@pytest.mark.parametrize("power", [1.0, 60.0])
def test_a_picture_that_stays_noisy_is_said_to_be(scene, render_and_log, capfd, power):
    """A world of points far smaller than a pixel: the higher the power, the fewer of them give most of the light."""

    def background(tree):
        direction = tree.add("ShaderNodeTexCoord").outputs["Generated"]
        points = tree.add("ShaderNodeTexWhiteNoise", {"Vector": direction}, noise_dimensions="3D").outputs["Value"]
        level = tree.add("ShaderNodeMath", {0: points, 1: power}, operation="POWER")
        return tree.add("ShaderNodeBackground", {"Strength": level})

    bpy.data.objects.remove(scene.objects["Light"])
    scene.world, scene.ism.render.samples = world_of(background), 16
    render_and_log()
    assert (engine.statistics()["error"] > 0.05) == (power > 1.0)
    said = re.findall(r"error is still about (\d+) % of its mean: more samples lower it", capfd.readouterr().out)
    assert said == ([f"{100.0 * engine.statistics()['error']:.0f}"] if power > 1.0 else [])


def test_the_time_limit_stops_a_render(scene, render_and_log):
    scene.ism.render.samples, scene.ism.render.time_limit = 65536, 0.001
    render_and_log()
    assert (engine.statistics()["stopped_by"], engine.statistics()["samples"]) == ("time", 1)


def test_settings_out_of_range_are_clamped_with_a_warning(scene, render_and_log, capfd):
    """Blender clamps its properties, but not the values that scripts and older files have stored in their place."""
    scene.ism.render["samples"], scene.ism.render["virtual_lights"] = 0, 10**6
    render_and_log()
    assert engine.statistics()["samples"] == 1
    warnings = re.findall(r"(?:Samples|Virtual Point Lights) cannot be .*", capfd.readouterr().out)
    assert sorted(warnings) == [
        "Samples cannot be 0: 1 is used instead.",
        "Virtual Point Lights cannot be 1,000,000: 4,096 is used instead.",
    ]


def test_images_that_are_drawn_smaller_are_reported(scene, render_and_log, capfd, monkeypatch):
    tree = scene.objects["Cube"].data.materials[0].node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("Picture", 256, 256)
    tree.links.new(node.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    monkeypatch.setattr(setting_limits, "MAX_TEXTURE_LINES", 3)
    render_and_log()
    assert "some not drawn at their size: 1 of 256×256 px at 1/2 of it." in capfd.readouterr().out
