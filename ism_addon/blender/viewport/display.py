# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws an image into the viewport with Blender's colour management and gpu module."""

import bpy
import gpu
import numpy as np
from gpu_extras.presets import draw_texture_2d

#: Left, bottom, width and height, in pixels of a region.
ViewportRect = tuple[float, float, float, float]


class ImageDisplay:
    """Draws images. Keeps the texture of the last one, because an upload is slow in large viewports."""

    def __init__(self) -> None:
        self._color: np.ndarray | None = None
        self._texture: gpu.types.GPUTexture | None = None

    def draw(
        self, engine: bpy.types.RenderEngine, scene: bpy.types.Scene, color: np.ndarray, rect: ViewportRect
    ) -> None:
        """Draw color (H,W,4), float32, scene-linear, premultiplied, bottom row first, into a rectangle."""
        if color is not self._color:
            rows, columns, channels = color.shape
            texels = gpu.types.Buffer("FLOAT", rows * columns * channels, color.reshape(-1))
            self._texture = gpu.types.GPUTexture((columns, rows), format="RGBA32F", data=texels)
            self._color = color
        gpu.state.blend_set("ALPHA_PREMULT")
        engine.bind_display_space_shader(scene)
        draw_texture_2d(self._texture, rect[:2], *rect[2:])
        engine.unbind_display_space_shader()
        gpu.state.blend_set("NONE")
