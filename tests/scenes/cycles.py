# SPDX-License-Identifier: GPL-3.0-or-later
"""Reference images of the open scene's direct light: Cycles without bounces, as float arrays."""

import tempfile
from pathlib import Path

import bpy
import numpy as np

PIXEL_CENTRES = 0.01  # px, the narrowest filter that Cycles has


def direct_light(
    samples: int, filter_width: float = PIXEL_CENTRES, bounces: int = 0, seed: int = 0, light_tree: bool = False
) -> np.ndarray:
    """Render the open file with Cycles on the processor: (H,W,4) float32 scene-linear, premultiplied, bottom row first.

    `filter_width` is that of the Blackman-Harris pixel filter, in pixels. The world's light is included.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "truth.exr"
        render_exr(path, samples, filter_width, bounces, seed, light_tree)
        return image_pixels(path)


def image_pixels(path: Path) -> np.ndarray:
    """An image file's pixels without colour conversion: (H,W,4) float32, bottom row first."""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)


def render_exr(
    path: Path,
    samples: int,
    filter_width: float = PIXEL_CENTRES,
    bounces: int = 0,
    seed: int = 0,
    light_tree: bool = False,
) -> None:
    """Write the image of `direct_light` as a 32-bit OpenEXR file. The scene keeps Cycles' settings."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples, cycles.seed, cycles.use_light_tree = samples, seed, light_tree
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = bounces
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", filter_width
    write_as_exr(path)


def write_as_exr(path: Path) -> None:
    """Render the open file as it is, to a 32-bit OpenEXR file."""
    render = bpy.context.scene.render
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "IMAGE"
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.image_settings.color_mode = "RGBA"
    render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
