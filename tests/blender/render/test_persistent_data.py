# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of an animation reuse what has not changed, and each equals the same frame rendered alone."""

from contextlib import ExitStack
from pathlib import Path

import bpy
import numpy as np
import pytest

from ism_addon.blender import engine
from ism_addon.blender.render import persistent_data
from ism_addon.blender.sync.geometry import meshes
from ism_addon.blender.sync.materials import images
from tests.blender.render.test_engine import prepare
from tests.support import exr
from tests.tools.new_file import open_empty_file

pytestmark = pytest.mark.usefixtures("registered")

FRAMES = 3


@pytest.fixture
def scene(tmp_path):
    """A textured cube on a floor under an area light, and a camera that moves sideways."""
    open_empty_file()
    bpy.ops.mesh.primitive_plane_add(size=20.0)
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(0.0, 0.0, 1.0))
    bpy.context.object.data.materials.append(textured())
    bpy.ops.object.light_add(type="AREA", location=(2.0, 0.0, 6.0))
    bpy.context.object.data.energy = 500.0
    bpy.ops.object.camera_add(location=(0.0, 0.0, 12.0))
    scene, camera = bpy.context.scene, bpy.context.object
    for frame in (1, FRAMES):
        camera.location.x = 0.5 * frame
        camera.keyframe_insert("location", frame=frame)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.frame_start, scene.frame_end = 1, FRAMES
    prepare(scene)
    return scene


def textured():
    """A material with an image of random texels."""
    image = bpy.data.images.new("Texels", 8, 8)
    image.pixels = np.random.default_rng(0).random(8 * 8 * 4, np.float32)
    material = bpy.data.materials.new("Textured")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    material.node_tree.links.new(texture.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    return material


@pytest.fixture
def render_animation(scene, tmp_path, monkeypatch):
    """render_animation(*handlers): each frame's channels, its statistics, and how many meshes were read for it.

    The handlers are called before each frame.
    """

    def render(*before_frame):
        read, statistics, read_counts = [], [], []

        def record(*_arguments):
            statistics.append(engine.statistics())
            read_counts.append(len(read))
            read.clear()

        scene.render.filepath = str(tmp_path / "frame_####")
        with ExitStack() as stack:
            patch = stack.enter_context(monkeypatch.context())
            patch.setattr(meshes, "read", lambda *what, original=meshes.read: read.append(what) or original(*what))
            for name, added in (("render_post", [record]), ("frame_change_pre", before_frame)):
                handlers = getattr(bpy.app.handlers, name)
                for handler in added:
                    handlers.append(handler)
                    stack.callback(handlers.remove, handler)
            bpy.ops.render.render(animation=True)
        return [exr.read(tmp_path / f"frame_{frame:04}.exr") for frame in range(1, FRAMES + 1)], statistics, read_counts

    return render


def render_alone(scene, frame, folder: Path):
    """Renders a frame without data of earlier renders: its channels."""
    persistent_data.forget()
    scene.render.use_persistent_data = False
    scene.frame_set(frame)
    scene.render.filepath = str(folder / "alone.exr")
    bpy.ops.render.render(write_still=True)
    return exr.read(folder / "alone.exr")


def is_equal(one, other) -> bool:
    return all(np.array_equal(one[name], other[name]) for name in one)


@pytest.mark.parametrize("persistent", [False, True])
def test_frames_reuse_the_scene_if_only_the_camera_moves(scene, render_animation, tmp_path, persistent):
    scene.render.use_persistent_data = persistent
    pictures, statistics, read = render_animation()
    drawn = [{name for name, row in each["passes"].items() if row["drawn"]} for each in statistics]
    reused = {"UploadMeshes", "UploadMaterials", "BuildBLAS"}
    assert drawn[0] >= reused
    for later in drawn[1:]:
        assert not later & reused
    assert statistics[1]["bytes_uploaded"] < 0.2 * statistics[0]["bytes_uploaded"]
    assert read == ([2, 0, 0] if persistent else [2, 2, 2])
    assert not is_equal(pictures[0], pictures[1])
    for frame, picture in enumerate(pictures, 1):
        assert is_equal(picture, render_alone(scene, frame, tmp_path)), f"frame {frame} is not the one rendered alone"


def edit_mesh(scene):
    mesh = bpy.data.objects["Cube"].data
    mesh.vertices[0].co.z -= 0.5
    mesh.update()


def edit_image(scene):
    image = bpy.data.images["Texels"]
    image.pixels = np.random.default_rng(scene.frame_current).random(8 * 8 * 4, np.float32)
    if scene.render.use_persistent_data:
        image.update_tag()  # otherwise Blender does not report the change


def paint_and_pack(scene):
    edit_image(scene)
    bpy.data.images["Texels"].pack()


def change_color_space(scene):
    bpy.data.images["Texels"].colorspace_settings.name = "Non-Color"
    if scene.render.use_persistent_data:
        bpy.data.images["Texels"].update_tag()


def edit_material(scene):
    tree = bpy.data.materials["Textured"].node_tree
    tree.links.clear()
    tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.1 * scene.frame_current, 0.5, 0.5, 1.0)


def hide(scene):
    bpy.data.objects["Cube"].hide_render = scene.frame_current == 2


@pytest.mark.parametrize("persistent", [False, True])
@pytest.mark.parametrize("edit", [edit_mesh, edit_image, edit_material, hide])
def test_edits_by_frame_change_handlers_are_rendered(scene, render_animation, tmp_path, edit, persistent):
    scene.render.use_persistent_data = persistent
    pictures, _statistics, _read = render_animation(lambda scene, *_more: scene.frame_current == 2 and edit(scene))
    assert is_equal(pictures[1], render_alone(scene, 2, tmp_path))
    if edit is not hide:
        assert is_equal(pictures[2], render_alone(scene, 3, tmp_path))


@pytest.mark.parametrize("persistent", [False, True])
def test_edits_between_renders_are_rendered(scene, render_animation, tmp_path, persistent):
    scene.render.use_persistent_data = persistent
    render_animation()
    for edit in (edit_mesh, edit_image, edit_material):
        edit(scene)
        scene.render.use_persistent_data = persistent
        pictures = render_animation()[0]
        assert is_equal(pictures[1], render_alone(scene, 2, tmp_path)), edit.__name__


@pytest.mark.parametrize("edit", [None, edit_image, paint_and_pack, change_color_space])
def test_a_packed_image_is_read_again_only_after_edits(scene, render_animation, tmp_path, monkeypatch, edit):
    """An unchanged image is read once, though Blender does not report that it is unchanged."""
    image = bpy.data.images["Texels"]
    image.pack()
    image.reload()
    assert image.source == "FILE"
    read = []
    monkeypatch.setattr(images, "read", lambda *what, original=images.read: read.append(what) or original(*what))
    pictures = render_animation(lambda scene, *_more: edit and scene.frame_current == 2 and edit(scene))[0]
    times = len(read)
    assert is_equal(pictures[1], render_alone(scene, 2, tmp_path))
    assert is_equal(pictures[2], render_alone(scene, 3, tmp_path))
    assert times == {None: 1, edit_image: 3, paint_and_pack: 2, change_color_space: 2}[edit]


def test_data_is_kept_after_a_render_only_with_persistent_data(scene, render_animation):
    render_animation()
    assert not persistent_data._layers
    scene.render.use_persistent_data = True
    render_animation()
    assert persistent_data._layers
    persistent_data.forget()


def test_of_several_view_layers_only_the_last_is_kept(scene, render_animation):
    scene.view_layers.new("Other")
    scene.render.use_persistent_data = True
    render_animation()
    assert [name for _scene, name in persistent_data._layers] == ["Other"]
    persistent_data.forget()
