# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of an animation share what did not change, and each is the picture that it is alone."""

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
    """A textured cube on a floor under a lamp, and a camera that goes past."""
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
def animated(scene, tmp_path, monkeypatch):
    """Renders all frames: their channels, what each took, and how many meshes were read for it."""

    def render(*each_frame):
        read, taken, counts = [], [], []

        def note(*_what):
            taken.append(engine.statistics())
            counts.append(len(read))
            read.clear()

        scene.render.filepath = str(tmp_path / "frame_####")
        with ExitStack() as stack:
            patch = stack.enter_context(monkeypatch.context())
            patch.setattr(meshes, "read", lambda *what, kept=meshes.read: read.append(what) or kept(*what))
            for handlers, ours in (("render_post", [note]), ("frame_change_pre", each_frame)):
                for handler in ours:
                    getattr(bpy.app.handlers, handlers).append(handler)
                    stack.callback(getattr(bpy.app.handlers, handlers).remove, handler)
            bpy.ops.render.render(animation=True)
        return [exr.read(tmp_path / f"frame_{frame:04}.exr") for frame in range(1, FRAMES + 1)], taken, counts

    return render


def alone(scene, frame, folder: Path):
    """A frame rendered with nothing kept."""
    persistent_data.forget()
    scene.render.use_persistent_data = False
    scene.frame_set(frame)
    scene.render.filepath = str(folder / "alone.exr")
    bpy.ops.render.render(write_still=True)
    return exr.read(folder / "alone.exr")


def same(one, other) -> bool:
    return all(np.array_equal(one[name], other[name]) for name in one)


@pytest.mark.parametrize("persistent", [False, True])
def test_only_the_camera_moves(scene, animated, tmp_path, persistent):
    scene.render.use_persistent_data = persistent
    pictures, taken, read = animated()
    drawn = [{name for name, row in each["passes"].items() if row["drawn"]} for each in taken]
    kept = {"UploadMeshes", "UploadMaterials", "BuildBLAS"}
    assert drawn[0] >= kept
    for later in drawn[1:]:
        assert not later & kept
    assert taken[1]["bytes_uploaded"] < 0.2 * taken[0]["bytes_uploaded"]
    assert read == ([2, 0, 0] if persistent else [2, 2, 2])
    assert not same(pictures[0], pictures[1])
    for frame, picture in enumerate(pictures, 1):
        assert same(picture, alone(scene, frame, tmp_path)), f"frame {frame} is another picture than alone"


def edit_mesh(scene):
    mesh = bpy.data.objects["Cube"].data
    mesh.vertices[0].co.z -= 0.5
    mesh.update()


def edit_image(scene):
    image = bpy.data.images["Texels"]
    image.pixels = np.random.default_rng(scene.frame_current).random(8 * 8 * 4, np.float32)
    if scene.render.use_persistent_data:
        image.update_tag()  # or Blender does not tell of it


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
def test_what_scripts_change_from_frame_to_frame_is_seen(scene, animated, tmp_path, edit, persistent):
    scene.render.use_persistent_data = persistent
    seen, _taken, _read = animated(lambda scene, *_more: scene.frame_current == 2 and edit(scene))
    assert same(seen[1], alone(scene, 2, tmp_path))
    if edit is not hide:
        assert same(seen[2], alone(scene, 3, tmp_path))


@pytest.mark.parametrize("persistent", [False, True])
def test_edits_between_renders_are_seen(scene, animated, tmp_path, persistent):
    scene.render.use_persistent_data = persistent
    animated()
    for edit in (edit_mesh, edit_image, edit_material):
        edit(scene)
        scene.render.use_persistent_data = persistent
        seen = animated()[0]
        assert same(seen[1], alone(scene, 2, tmp_path)), edit.__name__


@pytest.mark.parametrize("edit", [None, edit_image, paint_and_pack, change_color_space])
def test_a_packed_image_is_read_again_when_it_is_another(scene, animated, tmp_path, monkeypatch, edit):
    """Not from frame to frame, though Blender does not say that it is as it was; and edits are seen all the same."""
    image = bpy.data.images["Texels"]
    image.pack()
    image.reload()
    assert image.source == "FILE"
    read = []
    monkeypatch.setattr(images, "texels", lambda *what, kept=images.texels: read.append(what) or kept(*what))
    seen = animated(lambda scene, *_more: edit and scene.frame_current == 2 and edit(scene))[0]
    times = len(read)
    assert same(seen[1], alone(scene, 2, tmp_path))
    assert same(seen[2], alone(scene, 3, tmp_path))
    assert times == {None: 1, edit_image: 3, paint_and_pack: 2, change_color_space: 2}[edit]


def test_nothing_is_kept_after_the_job_but_with_persistent_data(scene, animated):
    animated()
    assert not persistent_data._layers
    scene.render.use_persistent_data = True
    animated()
    assert persistent_data._layers
    persistent_data.forget()


def test_of_several_layers_one_is_kept(scene, animated):
    scene.view_layers.new("Other")
    scene.render.use_persistent_data = True
    animated()
    assert [name for _scene, name in persistent_data._layers] == ["Other"]
    persistent_data.forget()
