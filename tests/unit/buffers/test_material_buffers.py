# SPDX-License-Identifier: GPL-3.0-or-later
"""More and larger images than one texture holds: the largest are drawn from smaller copies, and that is said."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon import setting_limits
from ism_addon.gpu.buffers.material_buffers import mip_chain
from ism_addon.scene import Image, Materials
from ism_addon.setting_limits import images_beyond_limits, images_within_limits, lines_for
from tests.support.small_scenes import draw, make_scene, quad, view_from_above


def noise(height: int, width: int, seed: int = 0) -> Image:
    texels = np.random.default_rng(seed).integers(0, 256, (height, width, 4), np.uint8)
    texels[..., 3] = 255
    return Image(texels)


def painted(*images: Image):
    """Quads side by side, each painted with one of the images, in their own light; and a view of all."""
    whole = len(images)
    meshes = [quad((k - whole / 2.0, -0.5, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)) for k in range(whole)]
    meshes = [replace(mesh, materials=np.full(2, k, np.uint32)) for k, mesh in enumerate(meshes)]
    materials = Materials(np.ones((whole, 3), np.float32), np.arange(whole, dtype=np.int32))
    scene = replace(make_scene(meshes, world=1.0), images=images, materials=materials)
    return scene, view_from_above(float(whole), (128 * whole, 128))


@pytest.mark.parametrize("size", [(1, 1), (7, 300), (64, 64), (5, 1), (33, 1024)])
def test_lines_are_those_of_the_halved_copies(size):
    chain = mip_chain(noise(*size))
    for halved in range(len(chain)):
        texels = sum(len(copy) for copy in chain[halved:])
        assert lines_for(size, halved) == -(-texels // setting_limits.TEXTURE_WIDTH)


def test_images_that_fit_are_drawn_as_they_are():
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


def test_a_smaller_copy_is_drawn_like_an_image_of_its_size(device, monkeypatch):
    """Beside others that stay as they are."""
    large, small = noise(256, 128), noise(16, 16, seed=1)
    scene, view = painted(small, large)
    whole = draw(device, scene, view).color
    halved = Image(mip_chain(large)[1].reshape(128, 64, 4))
    expected = draw(device, *painted(small, halved)).color
    monkeypatch.setattr(setting_limits, "MAX_TEXTURE_LINES", 2)
    assert images_within_limits(scene.images) == [0, 1]
    found = draw(device, *painted(Image(small.texels), Image(large.texels))).color  # others, for the device knows these
    assert np.abs(found - expected).max() < 0.01
    assert np.abs(found - whole).max() > 0.02
    assert np.array_equal(found[:, :128], whole[:, :128])


def test_three_images_of_4096_pixels_are_drawn_at_their_size(device):
    """One texture of 4096 texels to a line had no room for them."""
    images = tuple(Image(np.full((4096, 4096, 4), value, np.uint8)) for value in (64, 128, 255))
    assert images_beyond_limits(images) == ()
    color = draw(device, *painted(*images)).color
    assert [color[64, 64 + 128 * k, 0] for k in range(3)] == pytest.approx([0.0513, 0.2159, 1.0], abs=1e-3)
