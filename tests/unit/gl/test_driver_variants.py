# SPDX-License-Identifier: GPL-3.0-or-later
"""Mesa's software driver does not compile a shader again when sizes and counts of a scene change."""

import os
import subprocess
import sys
from dataclasses import replace

import moderngl
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ism_addon.gpu.gl import driver_variants
from ism_addon.render_passes import RENDER_PASSES
from ism_addon.resources import SUM_COLOR
from ism_addon.settings import SSAO
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    light,
    look_at,
    make_scene,
    quad,
    random_triangles,
    with_quality,
)
from tests.tools import project

#: Draws pictures one after the other, each for a client of its own. Prints how many files the driver's cache has after
#: each. With `pixel` a coarse preview is drawn first, as in a viewport.
DRAW = """
import os, sys, time
from dataclasses import replace
from pathlib import Path
import numpy as np
from ism_addon.gpu.jobs.job import Request
from ism_addon.gpu.jobs.render_thread import RenderThread
from ism_addon.scene import Image
from ism_addon.settings import SSAO
from tests.support.small_scenes import SMALL_SHADOW_MAPS, SMALL_SETTINGS, join_lights, light, look_at
from tests.support.small_scenes import no_lights, quad, random_triangles, make_scene, with_quality

FLOOR, FOLDER = quad((-3, -3, 0), (6, 0, 0), (0, 6, 0)), Path(os.environ["MESA_SHADER_CACHE_DIR"])
CHECKS = Image(np.random.default_rng(0).integers(0, 255, (8, 8, 4), np.uint8), True)
MAPS = with_quality(SMALL_SHADOW_MAPS, samples=2)
SETTINGS = with_quality(SMALL_SETTINGS, samples=6) if sys.argv[1] == "rays" else MAPS
BURIED = light(position=(0.0, 0.0, -1.0), axis_v=(0.0, 1.0, 0.0))  # under the floor, where it is occluded everywhere

def files():
    return sum(path.is_file() for path in FOLDER.rglob("*"))

def settled():
    "The number of files once it stays the same: the driver writes them in a thread of its own."
    before, now = -1, files()
    while now != before:
        time.sleep(0.1)
        before, now = now, files()
    return now

def draw(lights, triangles, size, pixel=0, faint=False, image=None, ssao=False):
    table = BURIED if lights else no_lights()
    for k in range(lights):
        table = join_lights(table, light(position=(0.4 * k - 0.8, 0.3 * k - 0.5, 2.0 + 0.1 * k)))
    if faint:
        table = join_lights(table, light(position=(0.2, 0.2, 1.5), radiance=0.002))
    meshes = [random_triangles(triangles)] if triangles else []
    scene = make_scene([FLOOR, *meshes], table, world=0.3, image=image)
    settings = replace(SETTINGS, ssao=SSAO(enabled=ssao))
    view = look_at((3.0, -3.0, 3.0), size=size, filter_width=1.5)
    job = worker.start(Request(scene, view, settings, preview_pixel_size=pixel), len(counts))
    while not job.finished:
        job.wait(1.0)
    assert not job.error and job.picture().color.any(), job.error
    counts.append(settled())

worker, counts = RenderThread(), []
PLAIN = [
    (2, 300, (90, 60)), (2, 300, (90, 60)), (3, 5000, (64, 32)), (1, 1, (33, 17), 2), (1, 20, (1, 1)),
    (3, 5000, (4, 300), 8), (0, 20, (128, 64)), (2, 1, (128, 128), 4), (1, 0, (90, 60)), (3, 5000, (33, 17)),
]
for scene in [PLAIN[0], *PLAIN[:0:-1]] if sys.argv[2] == "backwards" else PLAIN:
    draw(*scene)
draw(2, 300, (90, 60), faint=True)
draw(2, 300, (90, 60), image=CHECKS)
draw(2, 300, (90, 60), ssao=True)
draw(2, 300, (90, 60), 1, ssao=True)  # in a viewport, where it is steadied
draw(3, 5000, (32, 8), 2, image=CHECKS, ssao=True)
draw(6, 1, (50, 64), faint=True, ssao=True)
worker.stop()
print(*counts)
"""


@pytest.mark.parametrize(("method", "order"), [("rays", "forwards"), ("maps", "backwards")])
def test_another_picture_compiles_nothing(opened_device, tmp_path, method, order):
    """The same scene again; small and large meshes and tables, other light counts, other picture sizes.

    A feature that no earlier scene had adds the programs of its own and no others.
    """
    if "llvmpipe" not in opened_device.name:
        pytest.skip("only Mesa's cache is counted")
    run = subprocess.run(
        [sys.executable, "-c", DRAW, method, order],
        cwd=project.ROOT,
        env=os.environ | {"MESA_SHADER_CACHE_DIR": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=240,
    )
    assert run.returncode == 0, run.stderr
    first, *added = np.diff([0, *map(int, run.stdout.split())]).tolist()
    assert first > 20
    *plain, faint, image, ssao, steady, both, all_but_images = added
    assert plain == [0] * len(plain)
    assert (faint > 0) == (method == "rays")
    assert min(image, ssao, steady) > 0
    assert both == all_but_images == 0


@pytest.mark.parametrize("settings", [SMALL_SETTINGS, SMALL_SHADOW_MAPS], ids=["rays", "maps"])
@pytest.mark.parametrize("filter_width", [0.01, 1.5, 9.0])
def test_the_picture_does_not_depend_on_how_much_larger_textures_are(device, monkeypatch, settings, filter_width):
    """No pass reads their unused texels."""
    scene = make_scene([quad((-30, -30, 0), (60, 0, 0), (0, 60, 0)), random_triangles(300)], light(), world=0.5)
    view = look_at((1.0, -1.0, 1.0), size=(62, 40), filter_width=filter_width)
    settings = replace(with_quality(settings, samples=6), ssao=SSAO())
    expected = draw(device, scene, view, settings)
    monkeypatch.setattr(driver_variants, "side", lambda texels: texels + 9)
    enlarged = draw(device, scene, view, settings)
    assert enlarged.renderer.graph[SUM_COLOR].size == (71, 49)
    assert np.array_equal(enlarged.color, expected.color)
    assert np.array_equal(enlarged.renderer.error.variance, expected.renderer.error.variance)
    images, expected_images = (drawn.renderer.images(RENDER_PASSES) for drawn in (enlarged, expected))
    for name in images:
        assert np.array_equal(images[name], expected_images[name])


def test_overwriting_keeps_nothing_of_what_a_target_held(device):
    """Not even NaN and numbers whose digits are lost in a sum. Also where a draw covers a part of a block of pixels."""
    gl, size = device.gl, (37, 21)
    before = np.resize(np.float32([np.nan, np.inf, -np.inf, 5.0]), (size[1], size[0], 4))
    floats = gl.texture(size, 4, before.tobytes(), dtype="f4")
    large = gl.texture(size, 1, np.full(size[::-1], 1e10, np.float32).tobytes(), dtype="f4")
    integers = gl.texture(size, 1, np.full(size[::-1], 7, np.int32).tobytes(), dtype="i4")
    program = gl.program(
        vertex_shader="#version 410 core\nvoid main() { gl_Position = vec4(2 * gl_VertexID - 1, "
        "gl_VertexID == 1 ? 3.0 : -1.0, 0.0, 1.0); }",
        fragment_shader="#version 410 core\nlayout(location = 0) out vec4 color;\nlayout(location = 1) out int whole;\n"
        "layout(location = 2) out float small;\n"
        "void main() { color = vec4(0.5, -1.0, 0.0, 2.0); whole = 3; small = 0.1; }",
    )
    device.add()
    device.overwrite()
    gl.framebuffer([floats, integers, large]).use()
    gl.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
    color = np.frombuffer(floats.read(), np.float32).reshape(before.shape)
    drawn = np.frombuffer(integers.read(), np.int32).reshape(size[::-1]) == 3
    assert 0.3 < drawn.mean() < 0.9
    assert (color[drawn] == [0.5, -1.0, 0.0, 2.0]).all()
    assert np.array_equal(color[~drawn], before[~drawn], equal_nan=True)
    assert np.array_equal(np.frombuffer(large.read(), np.float32).reshape(drawn.shape) == np.float32(0.1), drawn)


@given(count=st.integers(0, 1 << 20), each=st.sampled_from([4, 8, 16]))
def test_buffers_are_hardly_larger_than_requested(count, each):
    rows = driver_variants.rows(count, each)
    size = rows * each
    assert count <= rows <= max(count + 1 + 256 // each, 256 // each + 1)
    assert size & (size - 1)
    assert size >> 8 & 255


@given(texels=st.integers(1, driver_variants.MAX_SIDE))
def test_sides_are_hardly_longer_than_requested(texels):
    side = driver_variants.side(texels)
    assert texels <= side <= min(max(texels + 1, 3), driver_variants.MAX_SIDE)
    assert side & (side - 1) or side == driver_variants.MAX_SIDE
