# SPDX-License-Identifier: GPL-3.0-or-later
"""Image textures: filtered in linear light, whatever the encoding of their texels."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.color import linear_from_srgb
from ism_addon.scene import Encoding, Image
from tests.scenes.parts.tables import materials_of
from tests.support import reference
from tests.support.small_scenes import make_scene, quad, view_from_above
from tests.unit.buffers.mip_chain import mip_chain

from .test_gbuffer import gbuffer


def pattern(width: int = 8, height: int = 4, repeat: bool = True) -> Image:
    """An sRGB image of random texels."""
    return encoded(np.random.default_rng(8).integers(0, 256, (height, width, 4), np.uint8), Encoding.SRGB, repeat)


def encoded(bytes_: np.ndarray, encoding: Encoding, repeat: bool = True) -> Image:
    """An image of bytes (H,W,4). As floats, values are three times as large, so that some exceed 1."""
    texels = (bytes_ / 85.0).astype(np.float16) if encoding is Encoding.FLOAT else bytes_
    return Image(texels, repeat, encoding)


def linear(image: Image) -> np.ndarray:
    """(H,W,3) linear values of its texels."""
    return decoded(image.texels[..., :3].astype(float), image.encoding)


def interpolated_mean(image: Image) -> np.ndarray:
    """(3,) mean of the linear values that interpolation of stored texels gives, of an image that repeats."""
    color = image.texels[..., :3].astype(float)
    for axis in (0, 1):
        after = np.roll(color, -1, axis)
        steps = ((np.arange(8) + 0.5) / 8.0).tolist()
        color = np.concatenate([color + t * (after - color) for t in steps], axis)
    return decoded(color, image.encoding).mean((0, 1))


def decoded(color: np.ndarray, encoding: Encoding) -> np.ndarray:
    """Linear values of stored ones."""
    if encoding is Encoding.FLOAT:
        return color
    return linear_from_srgb(color / 255.0) if encoding is Encoding.SRGB else color / 255.0


def bilinear(image: Image, uv: np.ndarray) -> np.ndarray:
    """(N,3) linear values of the bilinear interpolation between the texels' centres, as they are stored."""
    texels = image.texels[..., :3].astype(float)
    height, width = texels.shape[:2]
    at = (uv - np.floor(uv) if image.repeat else np.clip(uv, 0.0, 1.0)) * (width, height) - 0.5
    low = np.floor(at).astype(int)
    fraction = at - low
    color = np.zeros((len(uv), 3))
    for j in (0, 1):
        for i in (0, 1):
            x, y = low[:, 0] + i, low[:, 1] + j
            x, y = (x % width, y % height) if image.repeat else (x.clip(0, width - 1), y.clip(0, height - 1))
            weight = np.abs(1 - i - fraction[:, 0]) * np.abs(1 - j - fraction[:, 1])
            color += weight[:, None] * texels[y, x]
    return decoded(color, image.encoding)


@pytest.mark.parametrize("repeat", [True, False], ids=["repeat", "extend"])
@pytest.mark.parametrize("uv", [1.0, 2.5])
@pytest.mark.parametrize("encoding", Encoding)
def test_images_are_interpolated_bilinearly_as_they_are_stored(device, encoding, uv, repeat):
    image = encoded(pattern().texels, encoding, repeat)
    floor = quad((-1.0, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0), uv=uv)
    floor = replace(floor, uvs=floor.uvs - np.float32(0.4 * (uv > 1.0)))
    view = view_from_above(1.6, (64, 64))
    scene = make_scene([floor], image=image)
    truth = reference.surfaces(scene, view)
    at = (truth.position[:, :2] + 1.0) / 2.0 * uv - 0.4 * (uv > 1.0)
    ours = gbuffer(device, scene, view)
    error = np.abs(ours["base_color"][:, :3] - bilinear(image, at))
    assert error.max() <= 6e-3  # 8-bit sRGB, 16-bit floats


@pytest.mark.parametrize("encoding", Encoding)
def test_images_far_away_have_the_mean_colour(device, encoding):
    """A pixel that covers the whole image shows the average of what is interpolated, in linear light."""
    image = encoded(pattern(37, 23).texels, encoding)
    floor = quad((-50.0, -50.0, 0.0), (100.0, 0.0, 0.0), (0.0, 100.0, 0.0), uv=1000.0)
    ours = gbuffer(device, make_scene([floor], image=image), view_from_above(20.0, (16, 16)))
    mean = interpolated_mean(image)
    assert ours["base_color"][:, :3] == pytest.approx(np.tile(mean, (256, 1)), abs=0.02 * max(mean.max(), 1.0))


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (5, 1), (16, 16), (7, 13)])
@pytest.mark.parametrize("encoding", Encoding)
def test_mip_levels_keep_the_mean(encoding, shape):
    image = encoded(np.random.default_rng(1).integers(0, 256, (*shape, 4), np.uint8), encoding)
    chain = mip_chain(image)
    assert chain[0] is image.texels
    assert chain[-1].shape == (1, 1, 4)
    if all(math.log2(side).is_integer() for side in shape):
        last = linear(Image(chain[-1], encoding=encoding))[0, 0]
        assert last == pytest.approx(interpolated_mean(image), abs=0.015)


@pytest.mark.parametrize("shape", [(1, 1), (1, 8192), (8192, 1)])
@pytest.mark.parametrize("uv", [1.0, -1e8, 1e30])
def test_odd_sizes_and_far_coordinates_show_colours_of_the_image(device, shape, uv):
    texels = np.random.default_rng(2).integers(90, 160, (*shape, 4), np.uint8)
    floor = quad((-1.0, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0), uv=uv)
    color = gbuffer(device, make_scene([floor], image=Image(texels)), view_from_above(1.6, (16, 16)))["base_color"]
    low, high = linear_from_srgb(np.array([90, 160]) / 255.0)
    assert color[:, :3].min() > low - 6e-3 and color[:, :3].max() < high + 6e-3  # 8-bit sRGB


def test_images_of_all_encodings_side_by_side(device):
    """Each encoding has a texture of its own, and the shader's variant declares those that exist."""
    color = np.full((2, 2, 4), (60, 30, 90, 255), np.uint8)
    images = tuple(encoded(color, encoding) for encoding in Encoding)
    meshes = [
        replace(quad((x, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0)), materials=np.full(2, k, np.uint32))
        for k, x in enumerate((-1.5, -0.5, 0.5))
    ]
    materials = materials_of(np.zeros((3, 3)), np.arange(3))
    scene = replace(make_scene(meshes), materials=materials, images=images)
    base_color = gbuffer(device, scene, view_from_above(3.0, (30, 10)))["base_color"][:, :3].reshape(10, 30, 3)
    for k, image in enumerate(images):
        expected = np.broadcast_to(linear(image)[0, 0], (10, 8, 3))
        assert base_color[:, 10 * k + 1 : 10 * k + 9] == pytest.approx(expected, abs=2e-3)


def test_several_images_and_plain_colours_side_by_side(device):
    """Materials 0 and 2 have images, 1 a colour: each triangle takes its own."""
    images = (pattern(3, 5), Image(np.full((2, 2, 4), (200, 30, 90, 255), np.uint8)))
    meshes = [
        replace(quad((x, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0)), materials=np.full(2, k, np.uint32))
        for k, x in enumerate((-1.5, -0.5, 0.5))
    ]
    materials = materials_of([[0, 0, 0], [0.1, 0.2, 0.3], [0, 0, 0]], [0, -1, 1])
    ours = gbuffer(
        device, replace(make_scene(meshes), materials=materials, images=images), view_from_above(3.0, (30, 10))
    )
    base_color = ours["base_color"][:, :3].reshape(10, 30, 3)
    assert base_color[:, 11:19] == pytest.approx(np.broadcast_to([0.1, 0.2, 0.3], (10, 8, 3)), abs=1e-3)
    assert base_color[:, 21:] == pytest.approx(
        np.broadcast_to(linear_from_srgb(np.array([200, 30, 90]) / 255.0), (10, 9, 3)), abs=2e-3
    )
    assert base_color[:, :9].std() > 0.01
