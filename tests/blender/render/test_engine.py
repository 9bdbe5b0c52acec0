# SPDX-License-Identifier: GPL-3.0-or-later
"""Final renders by bpy.ops.render.render(), and the files that they write."""

import time

import bpy
import numpy as np
import pytest

from ism_addon.blender import engine
from ism_addon.blender.render import final_render
from tests.support import exr
from tests.tools.new_file import open_empty_file

WIDTH, HEIGHT = 48, 32
BACKGROUND = 1e9  # m: greater depths mean that the pixel shows no surface


pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def scene():
    """A cube of 2 m on a floor, an area light above, a camera straight above that sees 12 m by 8 m."""
    open_empty_file()
    bpy.ops.mesh.primitive_plane_add(size=100.0)
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(0.0, 0.0, 1.0))
    bpy.ops.object.light_add(type="AREA", location=(0.0, 0.0, 6.0))
    bpy.context.object.data.energy = 500.0
    bpy.ops.object.camera_add(location=(0.0, 0.0, 10.0))
    camera = bpy.context.object
    camera.data.type, camera.data.ortho_scale = "ORTHO", 12.0
    scene = bpy.context.scene
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    prepare(scene)
    return scene


def prepare(scene):
    """Set up a small, quick render that writes files which `exr` reads."""
    render = scene.render
    render.engine = "ISM"
    render.resolution_x, render.resolution_y, render.resolution_percentage = WIDTH, HEIGHT, 100
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "MULTI_LAYER_IMAGE"
    render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    render.image_settings.color_depth, render.image_settings.exr_codec = "32", "NONE"
    if hasattr(render.image_settings, "use_exr_interleave"):
        render.image_settings.use_exr_interleave = True
    view_layer = scene.view_layers[0]
    view_layer.name, view_layer.use_pass_z, view_layer.use_pass_normal = "Layer", True, True
    quality = scene.ism.render
    quality.samples, quality.virtual_lights, quality.map_size, quality.map_points = 2, 8, 32, 2000


@pytest.fixture
def render_channels(scene, tmp_path):
    """render_channels(): renders, and returns the channels of the written file."""

    def render():
        scene.render.filepath = str(tmp_path / "picture.exr")
        bpy.ops.render.render(write_still=True)
        return exr.read(tmp_path / "picture.exr")

    return render


def rgb(channels, layer="Layer"):
    return np.stack([channels[f"{layer}.Combined.{channel}"] for channel in "RGB"], -1)


def test_combined_depth_and_normal(render_channels):
    channels = render_channels()
    assert rgb(channels).shape == (HEIGHT, WIDTH, 3)
    assert np.isfinite(rgb(channels)).all()
    assert rgb(channels)[HEIGHT // 2, WIDTH // 2].min() > 0.0
    depth = channels["Layer.Depth.Z"]
    assert depth[HEIGHT // 2, WIDTH // 2] == pytest.approx(8.0, abs=1e-3)
    assert depth[2, 2] == pytest.approx(10.0, abs=1e-3)
    up = np.stack([channels[f"Layer.Normal.{axis}"] for axis in "XYZ"], -1)[2, 2]
    assert up == pytest.approx((0.0, 0.0, 1.0), abs=1e-2)


def test_rows_go_up_and_columns_to_the_right(scene, render_channels):
    bpy.data.objects["Cube"].location = (4.0, 2.0, 1.0)
    nearest = np.argwhere(render_channels()["Layer.Depth.Z"] < 9.0)
    row, column = nearest.mean(0) + 0.5
    assert (column, row) == pytest.approx((WIDTH / 2 + 16, HEIGHT / 2 + 8), abs=0.5)


def test_passes_are_made_only_when_the_view_layer_enables_them(scene, render_channels):
    scene.view_layers[0].use_pass_z = scene.view_layers[0].use_pass_normal = False
    assert {name.split(".")[1] for name in render_channels()} == {"Combined"}


def test_percentage(scene, render_channels):
    scene.render.resolution_percentage = 50
    assert rgb(render_channels()).shape == (HEIGHT // 2, WIDTH // 2, 3)


@pytest.mark.parametrize("crop", [False, True])
def test_a_border_renders_that_region_of_the_full_picture(scene, render_channels, crop):
    full = render_channels()["Layer.Depth.Z"]
    render = scene.render
    render.use_border, render.use_crop_to_border = True, crop
    render.border_min_x, render.border_max_x = 0.25, 0.75
    render.border_min_y, render.border_max_y = 0.5, 1.0
    region = render_channels()["Layer.Depth.Z"]
    inside = np.s_[HEIGHT // 2 :, WIDTH // 4 : WIDTH * 3 // 4]
    if not crop:
        assert region.shape == full.shape
        region = region[inside]
    assert region == pytest.approx(full[inside], abs=1e-3)


def test_every_view_layer_is_rendered(scene, render_channels):
    empty = scene.view_layers.new("Empty")
    empty.use_pass_z = True
    for child in empty.layer_collection.children:
        child.exclude = True
    collection = bpy.data.collections.new("Things")
    scene.collection.children.link(collection)
    empty.layer_collection.children["Things"].exclude = True
    cube = bpy.data.objects["Cube"]
    scene.collection.objects.unlink(cube)
    collection.objects.link(cube)
    channels = render_channels()
    assert channels["Layer.Depth.Z"].min() == pytest.approx(8.0, abs=1e-3)
    assert channels["Empty.Depth.Z"].min() == pytest.approx(10.0, abs=1e-3)


@pytest.mark.parametrize("mode, parallax", [("PARALLEL", WIDTH * 50 / 36 / 8), ("OFFAXIS", 0.0)])
def test_stereo_views_have_parallax(scene, tmp_path, mode, parallax):
    """A 50 mm lens, a 36 mm sensor, eyes 1 m apart and 8 m above the cube, which is where the axes of OFFAXIS meet."""
    scene.camera.data.type = "PERSP"
    stereo = scene.camera.data.stereo
    stereo.interocular_distance, stereo.convergence_distance, stereo.convergence_mode = 1.0, 8.0, mode
    scene.render.use_multiview = True
    scene.render.image_settings.views_format = "INDIVIDUAL"
    scene.render.filepath = str(tmp_path / "eye.exr")
    bpy.ops.render.render(write_still=True)
    left, right = (exr.read(tmp_path / f"eye_{side}.exr") for side in "LR")
    left, right = ((eye["Layer.Depth.Z"] < 9.0).nonzero()[1].mean() for eye in (left, right))
    assert left - right == pytest.approx(parallax, abs=0.6)


def test_the_background_is_the_world_or_transparent(scene, render_channels):
    bpy.data.objects.remove(bpy.data.objects["Plane"])
    alpha = render_channels()["Layer.Combined.A"]
    assert alpha[0, 0] == pytest.approx(1.0)
    scene.render.film_transparent = True
    alpha = render_channels()["Layer.Combined.A"]
    assert (alpha[0, 0], alpha[HEIGHT // 2, WIDTH // 2]) == pytest.approx((0.0, 1.0), abs=1e-3)


@pytest.mark.parametrize(("method", "has_virtual_lights"), [("RAY_TRACED", False), ("SHADOW_MAPS", True)])
def test_statistics_are_a_copy_of_the_last_render(scene, render_channels, method, has_virtual_lights):
    scene.ism.shadow.method = method
    render_channels()
    numbers = engine.statistics()
    assert numbers["samples"] == 2
    assert numbers["virtual_lights"] == (8 if has_virtual_lights else 0)
    assert numbers["triangles"] == 14
    assert (numbers["map_points"] > 0) is has_virtual_lights
    assert numbers["bytes_uploaded"] > 0 and numbers["seconds"] > 0.0
    for row in numbers["passes"].values():
        assert set(row) == {"drawn", "reused", "skipped", "ms"}
    numbers["passes"].clear()
    assert engine.statistics()["passes"]


def test_animated_settings_are_those_of_the_frame(scene, render_channels):
    for frame, samples in ((1, 1), (2, 3)):
        scene.ism.render.samples = samples
        scene.keyframe_insert("ism.render.samples", frame=frame)
    for frame, samples in ((1, 1), (2, 3)):
        scene.frame_set(frame)
        render_channels()
        assert engine.statistics()["samples"] == samples


@pytest.mark.parametrize("missing", ["LIGHT", "MESH"])
def test_a_scene_without_lights_or_meshes_is_rendered(scene, render_channels, missing):
    for thing in [thing for thing in bpy.data.objects if thing.type == missing]:
        bpy.data.objects.remove(thing)
    assert np.isfinite(rgb(render_channels())).all()


def test_one_pixel(scene, render_channels):
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 4, 4, 25
    channels = render_channels()
    assert rgb(channels).shape == (1, 1, 3)
    assert channels["Layer.Depth.Z"].item() < BACKGROUND


def test_a_missing_camera_is_reported_in_one_sentence(scene):
    scene.camera = None
    with pytest.raises(RuntimeError, match="camera"):
        bpy.ops.render.render()


def test_a_panoramic_camera_is_reported_in_one_sentence(scene, capfd):
    scene.camera.data.type = "PANO"
    with pytest.raises(RuntimeError, match="panoramic") as failure:
        bpy.ops.render.render()
    assert str(failure.value).strip().count("\n") == 0
    assert "Traceback" not in capfd.readouterr().err


class EngineWithEscape:
    """Wraps an engine and acts as if a user pressed Escape half a second after the first sample.

    A class that derives from the engine cannot do this: Blender's own functions take precedence over Python's.
    """

    def __init__(self, real_engine):
        self.real_engine, self.escape_time = real_engine, float("inf")

    def __getattr__(self, name):
        return getattr(self.real_engine, name)

    def update_progress(self, progress):
        if progress > 0.0:
            self.escape_time = min(self.escape_time, time.monotonic() + 0.5)

    def test_break(self):
        return self.escape_time < time.monotonic()


class CancelledRender(bpy.types.RenderEngine):
    bl_idname = "ISM_CANCELLED"
    bl_label = "ISM, cancelled"

    def update_render_passes(self, scene, renderlayer):
        engine.ISMRenderEngine.update_render_passes(self, scene, renderlayer)

    def render(self, depsgraph):
        wrapper = EngineWithEscape(self)
        final_render.render(wrapper, depsgraph)
        CancelledRender.seconds_to_stop = time.monotonic() - wrapper.escape_time


@pytest.mark.alone
def test_cancelled_render_stops_soon_and_keeps_its_picture(scene, render_channels):
    bpy.utils.register_class(CancelledRender)
    try:
        scene.render.engine, scene.ism.render.samples = CancelledRender.bl_idname, 65536
        scene.ism.render.error_threshold = 0.0  # else a fast machine finishes sooner
        channels = render_channels()
    finally:
        bpy.utils.unregister_class(CancelledRender)
    assert 0.0 < CancelledRender.seconds_to_stop < 0.3
    assert rgb(channels).max() > 0.0
