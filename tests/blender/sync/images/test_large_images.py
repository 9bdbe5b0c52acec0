# SPDX-License-Identifier: GPL-3.0-or-later
"""Large images: read in bands where possible, and not kept in memory more often than they must be."""

import io
import struct
import zlib

import bpy
import numpy as np
import pytest

from ism_addon.blender.render.persistent_data import LayerCache
from ism_addon.blender.sync.materials import images
from ism_addon.blender.sync.materials.large_png import LargePng, UnsupportedPng
from ism_addon.blender.sync.scene_reader import accept_all
from ism_addon.scene import texel_files
from tests.tools import memory

#: Types of colours in a PNG, by their number of channels.
COLOR_TYPES = {1: 0, 2: 4, 3: 2, 4: 6}


def chunk(type_: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + type_ + data + struct.pack(">I", zlib.crc32(type_ + data))


def png(bytes_: np.ndarray, filters: str = "01234", interlace: int = 0, more: bytes = b"") -> bytes:
    """A PNG of bytes (H,W,channels), top row first, whose rows have these filters in turn, in chunks of 100 bytes."""
    height, width, channels = bytes_.shape
    previous, lines = np.zeros(width * channels, int), b""
    for index, row in enumerate(bytes_.reshape(height, -1).astype(int)):
        left = np.concatenate([np.zeros(channels, int), row[:-channels]])
        corner = np.concatenate([np.zeros(channels, int), previous[:-channels]])
        estimate = left + previous - corner
        distance = np.abs(estimate - np.array([left, previous, corner]))
        paeth = np.choose(distance.argmin(0), [left, previous, corner])
        filter_ = int(filters[index % len(filters)])
        predicted = (0 * row, left, previous, (left + previous) // 2, paeth)[filter_ % 5]
        lines += bytes([filter_]) + (row - predicted).astype(np.uint8).tobytes()
        previous = row
    header = struct.pack(">IIBBBBB", width, height, 8, COLOR_TYPES[channels], 0, 0, interlace)
    data = zlib.compress(lines)
    parts = b"".join(chunk(b"IDAT", data[first : first + 100]) for first in range(0, len(data), 100))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + more + parts + chunk(b"IEND", b"")


def noise(channels: int, height: int = 37, width: int = 23) -> np.ndarray:
    return np.random.default_rng(5).integers(0, 256, (height, width, channels), np.uint8)


def loaded(path, file: bytes, pack: bool = False) -> bpy.types.Image:
    path.write_bytes(file)
    image = bpy.data.images.load(str(path))
    if pack:
        image.pack()
    return image


@pytest.fixture
def in_bands(monkeypatch):
    """Images are read in bands of four rows of 23 texels."""
    monkeypatch.setattr(images, "TEXELS_AT_ONCE", 100)
    monkeypatch.setattr(images, "BAND_TEXELS", 4 * 23 + 7)


@pytest.mark.parametrize("pack", [False, True], ids=["file", "packed"])
@pytest.mark.parametrize("space", ["sRGB", "Non-Color"])
@pytest.mark.parametrize("alpha_mode", ["STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"])
@pytest.mark.parametrize("channels", COLOR_TYPES)
def test_bands_make_the_texels_of_the_whole(empty_scene, tmp_path, monkeypatch, channels, alpha_mode, space, pack):
    image = loaded(tmp_path / "noise.png", png(noise(channels)), pack)
    image.colorspace_settings.name, image.alpha_mode = space, alpha_mode
    monkeypatch.setattr(images, "TEXELS_AT_ONCE", 100)
    monkeypatch.setattr(images, "BAND_TEXELS", 4 * 23 + 7)
    read = [images.read(image, True, on_black) for on_black in (False, True)]
    is_cut = channels in (1, 3) or (channels == 4 and alpha_mode in images.UNCHANGED)
    assert image.has_data != is_cut
    monkeypatch.setattr(images, "TEXELS_AT_ONCE", 1 << 26)
    for by_bands, on_black in zip(read, (False, True), strict=True):
        whole = images.read(image, True, on_black)
        assert np.array_equal(by_bands.texels, whole.texels)
        assert by_bands.encoding is whole.encoding
    if alpha_mode == "CHANNEL_PACKED":
        assert np.array_equal(
            read[0].texels[::-1, :, :3], np.broadcast_to(noise(channels)[..., : 3 if channels > 2 else 1], (37, 23, 3))
        )


@pytest.mark.parametrize(
    "file",
    [
        b"",
        b"GIF89a",
        png(noise(3))[:40],
        png(noise(3))[:-60],
        png(noise(3), more=chunk(b"tRNS", b"\0\1\0\2\0\3")),
        png(noise(3), interlace=1),
        png(noise(2)),
    ],
    ids=["empty", "GIF", "header", "short", "transparent colour", "interlaced", "grey with alpha"],
)
def test_other_files_are_not_cut(file):
    with pytest.raises(UnsupportedPng):
        LargePng(io.BytesIO(file)).band(37, b"")


def damaged() -> bytes:
    file = bytearray(png(noise(3)))
    file[len(file) // 2] ^= 255
    return bytes(file)


@pytest.mark.parametrize("file", [damaged(), png(noise(3), filters="01239")], ids=["damaged", "unknown filter"])
def test_what_blender_cannot_decode_is_not_drawn(textured, read_scene, tmp_path, in_bands, file):
    textured(loaded(tmp_path / "damaged.png", file))
    scene = read_scene()
    assert scene.images == ()
    assert scene.warnings == ("Images that are missing or cannot be read are magenta, as in Blender: 'damaged.png'.",)


def test_a_painted_image_is_not_read_from_its_file(empty_scene, tmp_path, in_bands):
    image = loaded(tmp_path / "noise.png", png(noise(3)))
    image.pixels.foreach_set(np.ones(len(image.pixels), np.float32))
    assert (images.read(image).texels == 255).all()


def test_a_decoded_image_is_not_read_from_a_file_that_has_changed_since(empty_scene, tmp_path, in_bands):
    path = tmp_path / "noise.png"
    image = loaded(path, png(noise(3)))
    len(image.pixels)
    path.write_bytes(png(255 - noise(3)))
    assert np.array_equal(images.read(image).texels[::-1, :, :3], noise(3))


def test_texels_of_large_images_are_in_a_file(empty_scene):
    """Reading one leaves nothing of it in this process."""
    if not memory.resident():
        pytest.skip("no /proc")
    image = bpy.data.images.new("Large", 4096, 2048)
    len(image.pixels)
    before = memory.resident()
    read = images.read(image)
    assert read.texels.nbytes >= 4 * texel_files.MIN_FILE_BYTES
    assert memory.resident() - before < read.texels.nbytes / 4
    assert (read.texels[::100, ::100] == (0, 0, 0, 255)).all()


@pytest.mark.parametrize("decoded_before", [False, True])
def test_a_final_render_frees_what_blender_decodes_for_it(textured, tmp_path, decoded_before):
    image = loaded(tmp_path / "noise.png", png(noise(3)))
    textured(image)
    if decoded_before:
        len(image.pixels)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    scene = LayerCache(frees_images=True).read(depsgraph, accept_all)
    assert image.has_data == decoded_before
    assert np.array_equal(scene.images[0].texels[::-1, :, :3], noise(3))


def test_an_unchanged_file_is_read_once(textured, tmp_path, monkeypatch):
    path, read = tmp_path / "noise.png", []
    textured(loaded(path, png(noise(3))))
    monkeypatch.setattr(images, "read", lambda *what, original=images.read: read.append(what) or original(*what))
    depsgraph, cache = bpy.context.evaluated_depsgraph_get(), LayerCache(frees_images=True)
    for _ in range(3):
        cache.reader.invalidate()
        cache.read(depsgraph, accept_all)
    assert len(read) == 1
    path.write_bytes(png(255 - noise(3)))
    cache.reader.invalidate()
    assert np.array_equal(cache.read(depsgraph, accept_all).images[0].texels[::-1, :, :3], 255 - noise(3))
