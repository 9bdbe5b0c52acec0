# SPDX-License-Identifier: GPL-3.0-or-later
"""The same file, settings and driver give the same bits, in any process, order and beside any other renders."""

import hashlib
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import bpy
import numpy as np
import pytest

from ism_addon import addon, snapshot
from ism_addon.settings import SSAO, Method, Quality, Settings, Shadow
from tests.scenes.small import SMALL
from tests.support import exr
from tests.support.small_scenes import draw
from tests.tools import project
from tests.tools.new_file import open_empty_file

BASE_SETTINGS = Settings(ssao=SSAO(), quality=Quality(samples=9, virtual_lights=16, map_size=32, map_points=2048))
METHODS = {method: replace(BASE_SETTINGS, shadow=Shadow(method=method)) for method in Method}
BOTH_METHODS = pytest.mark.parametrize("method", Method, ids=[method.label for method in Method])
FRAMES = 4


@BOTH_METHODS
def test_renderers_side_by_side(device, method):
    """Three renderers of one context draw in alternation, pass by pass."""
    from ism_addon.gpu.profile import Profile
    from ism_addon.gpu.renderer import Renderer

    pictures = [(*make(64, 48), METHODS[method]) for make in SMALL.values()]
    renderers = [Renderer(device) for _ in pictures]

    def passes(renderer: Renderer, picture: tuple) -> Iterator[str]:
        profile = Profile()
        for sample in range(picture[2].quality.samples):
            yield from renderer.sample(*picture, sample, profile)

    running = [passes(*each) for each in zip(renderers, pictures, strict=True)]
    while running:
        running = [each for each in running if next(each, None)]
    for renderer, picture in zip(renderers, pictures, strict=True):
        assert np.array_equal(renderer.picture(), draw(device, *picture).color)


@BOTH_METHODS
@pytest.mark.parametrize("name", SMALL)
def test_another_process(device, tmp_path, method, name):
    """A new process draws what this one draws, whatever this one has drawn before."""
    path, picture = tmp_path / "scene.npz", (*SMALL[name](64, 48), METHODS[method])
    snapshot.save(path, *picture)
    lines = (
        "import hashlib, sys",
        "from ism_addon import snapshot",
        "from ism_addon.gpu.gl.context import open_device",
        "from tests.support.small_scenes import draw",
        "print(hashlib.sha256(draw(open_device(), *snapshot.load(sys.argv[1])).color.tobytes()).hexdigest())",
    )
    command = [sys.executable, "-c", "\n".join(lines), path]
    digest = subprocess.run(command, check=True, capture_output=True, text=True, cwd=project.ROOT).stdout.strip()
    assert digest == hashlib.sha256(draw(device, *picture).color.tobytes()).hexdigest()


@pytest.fixture
def animation(tmp_path):
    """A file in which the camera, a mesh and a light move."""
    addon.register()
    open_empty_file()
    bpy.ops.mesh.primitive_plane_add(size=20.0)
    bpy.ops.mesh.primitive_monkey_add(location=(0.0, 0.0, 1.0))
    moving = [bpy.context.object]
    bpy.ops.object.light_add(type="AREA", location=(2.0, 0.0, 6.0))
    bpy.context.object.data.energy = 500.0
    moving.append(bpy.context.object)
    bpy.ops.object.camera_add(location=(0.0, -8.0, 5.0), rotation=(1.0, 0.0, 0.0))
    moving.append(bpy.context.object)
    for index, each in enumerate(moving):
        for frame in (1, FRAMES):
            each.location.x += 0.1 * frame * (index + 1)
            each.keyframe_insert("location", frame=frame)
    scene = bpy.context.scene
    scene.camera, scene.frame_start, scene.frame_end = moving[-1], 1, FRAMES
    scene.render.engine, scene.render.resolution_x, scene.render.resolution_y = "ISM", 96, 54
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth, scene.render.image_settings.exr_codec = "32", "NONE"
    scene.ism.render.samples = 5
    path = tmp_path / "animation.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    addon.unregister()
    return path


def render_frames(animation, folder, frames: list[int], persistent: bool = False) -> None:
    """Render some frames in a new process, as a render farm does: `blender -b animation -o folder/#### -f frames`."""
    lines = (
        "import sys",
        "import bpy",
        "from ism_addon import addon",
        "addon.register()",
        "file, folder, persistent, *frames = sys.argv[1:]",
        "bpy.ops.wm.open_mainfile(filepath=file)",
        "scene = bpy.context.scene",
        "scene.render.use_persistent_data = persistent == 'True'",
        "for frame in map(int, frames):",
        "    scene.frame_set(frame)",
        "    scene.render.filepath = f'{folder}/{frame:04}'",
        "    bpy.ops.render.render(write_still=True)",
    )
    command = [sys.executable, "-c", "\n".join(lines), animation, folder, str(persistent), *map(str, frames)]
    subprocess.run(command, check=True, capture_output=True, cwd=project.ROOT)


def pictures(folder) -> list[dict[str, np.ndarray]]:
    return [exr.read(folder / f"{frame:04}.exr") for frame in range(1, FRAMES + 1)]


def test_an_animation_in_chunks(animation, tmp_path):
    """In chunks by two processes, backwards, or with Persistent Data: each frame has the same bits."""
    whole, chunks, backwards, kept = (tmp_path / name for name in ("whole", "chunks", "backwards", "kept"))
    every = list(range(1, FRAMES + 1))
    render_frames(animation, whole, every)
    with ThreadPoolExecutor(2) as farm:
        list(farm.map(lambda frames: render_frames(animation, chunks, frames), [[1], [2], [3, 4]]))
    render_frames(animation, backwards, every[::-1])
    render_frames(animation, kept, every, persistent=True)
    expected = pictures(whole)
    assert not all(np.array_equal(expected[0][name], expected[-1][name]) for name in expected[0])
    for folder in (chunks, backwards, kept):
        for frame, (one, other) in enumerate(zip(expected, pictures(folder), strict=True), 1):
            assert one.keys() == other.keys()
            assert all(np.array_equal(one[name], other[name]) for name in one), f"{folder.name}, frame {frame}"
