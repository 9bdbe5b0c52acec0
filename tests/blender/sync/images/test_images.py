# SPDX-License-Identifier: GPL-3.0-or-later
"""UV layers of image textures, and the frames of image sequences and movies."""

import bpy
import numpy as np
import pytest
from bpy.app.handlers import depsgraph_update_post

from ism_addon.blender.sync import scene_reader


def test_a_uv_map_node_selects_the_layer_and_can_be_edited(textured, read_scene, latest_scene):
    node = textured(bpy.data.images.new("Picture", 2, 2), ("First", "Second"))
    uv_map = node.id_data.nodes.new("ShaderNodeUVMap")
    node.id_data.links.new(uv_map.outputs["UV"], node.inputs["Vector"])
    for name, value in (("Second", 0.5), ("First", 0.25), ("Second", 0.5), ("Gone", 0.0)):
        uv_map.uv_map = name
        for scene in (latest_scene(), read_scene()):
            assert np.all(scene.meshes[0].uvs == value)
            assert scene.warnings == ()


def test_uvs_are_read_only_where_there_is_an_image(textured, read_scene):
    """They are added and removed with the image, though the mesh has not changed."""
    node, reader, scenes = textured(None, ("First", "Second")), scene_reader.Reader(), []
    handler = lambda _scene, depsgraph: scenes.append(reader.read(depsgraph))  # noqa: E731
    depsgraph_update_post.append(handler)
    try:
        for image in (None, bpy.data.images.new("Picture", 2, 2), None):
            node.image = image
            bpy.context.view_layer.update()
            for scene in (scenes[-1], read_scene()):
                assert len(scene.meshes[0].uvs) == (2 if image else 0)
    finally:
        depsgraph_update_post.remove(handler)


@pytest.fixture
def sequence(tmp_path):
    """Images in the files s0001.png to s0005.png; frame n is red with a value of n/5."""
    for frame in range(1, 6):
        image = bpy.data.images.new("Frame", 2, 2)
        image.pixels.foreach_set(np.float32([frame / 5, 0, 0, 1] * 4))
        image.filepath_raw, image.file_format = str(tmp_path / f"s{frame:04}.png"), "PNG"
        image.save()
    loaded = bpy.data.images.load(str(tmp_path / "s0001.png"))
    loaded.source = "SEQUENCE"
    return loaded


def test_a_sequence_shows_the_frame_of_its_image_user(textured, read_scene, latest_scene, sequence, empty_scene):
    node = textured(sequence)
    user = node.image_user
    user.frame_duration, user.use_auto_refresh = 5, True
    for frame, offset, expected in [(1, 0, 1), (3, 0, 3), (9, 0, 5), (2, 2, 4), (2, 0, 2), (3, 0, 3)]:
        user.frame_offset = offset
        empty_scene.frame_set(frame)
        for scene in (latest_scene(), read_scene()):
            assert [image.texels[0, 0].tolist() for image in scene.images] == [[51 * expected, 0, 0, 255]]
            assert scene.warnings == ()


def test_a_missing_frame_is_reported(textured, read_scene, sequence, empty_scene, tmp_path):
    textured(sequence).image_user.frame_duration = 5
    (tmp_path / "s0002.png").unlink()
    empty_scene.frame_set(2)
    assert read_scene().warnings == (
        "Images that are missing or cannot be read are magenta, as in Blender: 's0001.png'.",
    )


def test_a_sequence_with_two_offsets_is_two_images(textured, read_scene, sequence, empty_scene):
    for offset in (0, 2):
        user = textured(sequence).image_user
        user.frame_duration, user.frame_offset, user.use_auto_refresh = 5, offset, True
    empty_scene.frame_set(1)
    assert [image.texels[0, 0, 0] for image in read_scene().images] == [51, 153]


def test_one_frame_of_a_movie_is_drawn_and_that_is_reported(textured, read_scene, empty_scene, tmp_path):
    empty_scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    render = empty_scene.render
    render.engine, empty_scene.cycles.samples, render.resolution_x, render.resolution_y = "CYCLES", 1, 64, 32
    render.filepath, empty_scene.frame_end = str(tmp_path / "movie"), 2
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "VIDEO"
    render.image_settings.file_format = "FFMPEG"
    bpy.ops.render.render(animation=True)
    (movie,) = tmp_path.iterdir()
    textured(bpy.data.images.load(str(movie)))
    scene = read_scene()
    assert scene.images[0].texels.shape == (32, 64, 4)
    assert scene.warnings == (f"Of movies one frame is drawn: '{movie.name}'.",)
