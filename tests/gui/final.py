# SPDX-License-Identifier: GPL-3.0-or-later
"""F12's picture, and the viewport that shows the same."""

from pathlib import Path

import bpy

from .stage import Stage

#: view_camera_zoom at which the camera's frame is as wide as the region: ((√2 + zoom / 50) / 2)² = 1.
FILLS = 50.0 * (2.0 - 2.0**0.5)


def through_camera(stage: Stage) -> None:
    """The camera's frame fills the region, pixel by pixel."""
    render, region = stage.scene.render, stage.region
    render.resolution_x, render.resolution_y, render.resolution_percentage = region.width, region.height, 100
    stage.view.view_perspective = "CAMERA"
    stage.view.view_camera_zoom = FILLS
    stage.view.view_camera_offset = (0.0, 0.0)


def render(stage: Stage, path: Path) -> None:
    """F12, with as many samples as the viewport."""
    ism = stage.scene.ism
    for name in ("samples", "virtual_lights", "map_size", "map_points"):
        setattr(ism.render, name, getattr(ism.viewport, name))
    stage.scene.render.filepath = str(path)
    stage.scene.render.dither_intensity = 0.0  # the viewport has none
    with bpy.context.temp_override(window=stage.window):
        bpy.ops.render.render(write_still=True)
