# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators Save Snapshot and Reload Shaders, called from editors and scripts."""

import bpy
import numpy as np
import pytest

from ism_addon import snapshot
from ism_addon.blender.render import read_settings
from ism_addon.blender.sync import camera
from ism_addon.gpu.jobs.render_thread import shared
from ism_addon.settings import DebugView
from tests.tools.new_file import open_factory_file

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def scene():
    """The factory scene, with different samples for renders and viewports."""
    scene = open_factory_file()
    scene.render.engine = "ISM"
    scene.render.resolution_x, scene.render.resolution_y = 40, 20
    scene.ism.render.samples, scene.ism.viewport.samples = 5, 3
    scene.ism.debug_view = "depth"
    return scene


@pytest.fixture
def viewport():
    """The 3D viewport of the window, and its region of type WINDOW."""
    area = next(area for area in bpy.context.window.screen.areas if area.type == "VIEW_3D")
    return area, next(region for region in area.regions if region.type == "WINDOW")


def test_outside_of_viewports_a_snapshot_has_the_cameras_view(scene, tmp_path):
    assert bpy.ops.ism.save_snapshot(filepath=str(tmp_path / "a.npz")) == {"FINISHED"}
    saved, view, settings = snapshot.load(tmp_path / "a.npz")
    assert saved.triangle_count == 12
    assert (view.width, view.height) == (40, 20)
    expected = camera.final_view(bpy.context.evaluated_depsgraph_get())
    assert np.array_equal(view.clip_from_view, expected.clip_from_view)
    assert settings == read_settings.read(scene, "render")
    assert (settings.quality.samples, settings.debug_view) == (5, DebugView.SAMPLE_COLOR)


@pytest.mark.parametrize("pressed_in", ["WINDOW", "HEADER"])
@pytest.mark.parametrize(("resolution", "pixels"), [("100", 1), ("25", 4)])
def test_in_a_viewport_a_snapshot_has_its_view(scene, viewport, tmp_path, pressed_in, resolution, pixels):
    area, window = viewport
    scene.ism.viewport.resolution = resolution
    region = next(region for region in area.regions if region.type == pressed_in)
    with bpy.context.temp_override(area=area, region=region):
        bpy.ops.ism.save_snapshot(filepath=str(tmp_path / "a.npz"))
    _, view, settings = snapshot.load(tmp_path / "a.npz")
    assert (view.width, view.height) == (window.width // pixels, window.height // pixels)
    assert np.array_equal(view.clip_from_view, np.array(area.spaces.active.region_3d.window_matrix))
    assert settings == read_settings.read(scene, "viewport")
    assert (settings.quality.samples, settings.debug_view) == (3, DebugView.DEPTH)


def test_in_a_viewport_a_snapshot_leaves_out_hidden_objects(scene, viewport, tmp_path):
    area, region = viewport
    area.spaces.active.show_object_viewport_mesh = False
    with bpy.context.temp_override(area=area, region=region):
        bpy.ops.ism.save_snapshot(filepath=str(tmp_path / "a.npz"))
    saved, _, _ = snapshot.load(tmp_path / "a.npz")
    assert saved.triangle_count == 0


def test_a_snapshot_without_a_camera_is_an_error(scene, tmp_path):
    scene.camera = None
    with pytest.raises(RuntimeError, match="not saved: The scene has no active camera"):
        bpy.ops.ism.save_snapshot(filepath=str(tmp_path / "a.npz"))
    assert not (tmp_path / "a.npz").exists()


def test_a_snapshot_that_cannot_be_written_is_an_error(scene, tmp_path):
    with pytest.raises(RuntimeError, match=r"not saved: .*no folder"):
        bpy.ops.ism.save_snapshot(filepath=str(tmp_path / "no folder" / "a.npz"))


def test_the_operators_are_unavailable_in_other_engines(scene):
    scene.render.engine = "BLENDER_WORKBENCH"
    assert not bpy.ops.ism.save_snapshot.poll()
    assert not bpy.ops.ism.reload_shaders.poll()


def test_reload_shaders_increases_the_shader_version(scene):
    """The render thread then reads the files again, which test_reload tests."""
    before = shared.shader_version
    assert bpy.ops.ism.reload_shaders() == {"FINISHED"}
    assert shared.shader_version == before + 1
