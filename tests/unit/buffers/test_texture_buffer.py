# SPDX-License-Identifier: GPL-3.0-or-later
"""Images that one texture cannot hold: the largest are drawn from smaller mip levels, and a message says so."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon import setting_limits
from ism_addon.gpu.buffers import texture_buffer
from ism_addon.scene import Image
from ism_addon.setting_limits import images_beyond_limits, images_within_limits, lines_for
from tests.scenes.parts.tables import materials_of
from tests.support.small_scenes import draw, make_scene, quad, view_from_above
from tests.unit.buffers.mip_chain import mip_chain


def noise(height: int, width: int, seed: int = 0) -> Image:
    texels = np.random.default_rng(seed).integers(0, 256, (height, width, 4), np.uint8)
    texels[..., 3] = 255
    return Image(texels)


def textured_quads(*images: Image):
    """Quads side by side, each textured with one of the images, lit by the world; and a view of all."""
    count = len(images)
    meshes = [quad((k - count / 2.0, -0.5, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)) for k in range(count)]
    meshes = [replace(mesh, materials=np.full(2, k, np.uint32)) for k, mesh in enumerate(meshes)]
    materials = materials_of(np.ones((count, 3)), np.arange(count))
    scene = replace(make_scene(meshes, world=1.0), images=images, materials=materials)
    return scene, view_from_above(float(count), (128 * count, 128))


@pytest.mark.parametrize("size", [(1, 1), (7, 300), (64, 64), (5, 1), (33, 1024)])
def test_lines_hold_all_mip_levels_that_are_used(size):
    chain = mip_chain(noise(*size))
    for halved in range(len(chain)):
        texels = sum(level.size // 4 for level in chain[halved:])
        assert lines_for(size, halved) == -(-texels // setting_limits.TEXTURE_WIDTH)


def test_images_that_fit_are_drawn_at_full_size():
    images = noise(256, 256), noise(3, 5)
    assert images_within_limits(images) == [0, 0]
    assert images_beyond_limits(images) == ()
    assert images_within_limits(()) == []


def test_the_largest_are_halved_until_all_fit(monkeypatch):
    images = noise(64, 64), noise(512, 256), noise(256, 512), noise(1024, 1024)
    monkeypatch.setattr(setting_limits, "MAX_TEXTURE_LINES", 25)
    halved = images_within_limits(images)
    assert halved == [0, 1, 0, 2]
    assert sum(lines_for(image.texels.shape[:2], times) for image, times in zip(images, halved, strict=True)) <= 25
    assert images_beyond_limits(images) == (
        "Images are larger than can be drawn together, and some not drawn at their size: "
        "1 of 256×512 px at 1/2 of it, 1 of 1024×1024 px at 1/4 of it.",
    )


def test_a_halved_image_is_drawn_like_an_image_of_that_size(device, monkeypatch):
    """The other image keeps its full size."""
    large, small = noise(256, 128), noise(16, 16, seed=1)
    scene, view = textured_quads(small, large)
    full_size = draw(device, scene, view).color
    halved = Image(mip_chain(large)[1])
    expected = draw(device, *textured_quads(small, halved)).color
    monkeypatch.setattr(setting_limits, "MAX_TEXTURE_LINES", 2)
    assert images_within_limits(scene.images) == [0, 1]
    # New objects, as the device has already uploaded those at their full size.
    color = draw(device, *textured_quads(Image(small.texels), Image(large.texels))).color
    assert np.abs(color - expected).max() < 0.01
    assert np.abs(color - full_size).max() > 0.02
    assert np.array_equal(color[:, :128], full_size[:, :128])


def test_images_of_several_layers_are_drawn_at_their_size(device, monkeypatch):
    """Layers of 3 lines: an image of 2^18 texels has 16 lines, and its levels more."""
    images = tuple(noise(512, 512, seed=k) for k in range(3))
    expected = draw(device, *textured_quads(*images)).color
    monkeypatch.setattr(texture_buffer, "LAYER_LINES", 3)
    color = draw(device, *textured_quads(*(Image(image.texels) for image in images))).color
    assert np.array_equal(color, expected)


def test_sixteen_images_of_4096_pixels_and_one_of_16384_fit():
    texels = np.broadcast_to(np.uint8(0), (4096, 4096, 4)), np.broadcast_to(np.uint8(0), (16384, 16384, 4))
    assert images_beyond_limits([Image(texels[0])] * 16) == ()
    assert images_beyond_limits([Image(texels[1])]) == ()
    assert images_beyond_limits([Image(texels[1])] * 2) != ()


def test_three_images_of_4096_pixels_are_drawn_at_their_size(device):
    images = tuple(Image(np.full((4096, 4096, 4), value, np.uint8)) for value in (64, 128, 255))
    assert images_beyond_limits(images) == ()
    color = draw(device, *textured_quads(*images)).color
    assert [color[64, 64 + 128 * k, 0] for k in range(3)] == pytest.approx([0.0513, 0.2159, 1.0], abs=1e-3)
