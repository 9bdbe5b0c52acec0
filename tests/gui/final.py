# SPDX-License-Identifier: GPL-3.0-or-later
"""F12's picture, and the viewport that shows the same."""

from pathlib import Path

import bpy

from .session import Session

#: view_camera_zoom at which the camera's frame is as wide as the region: ((√2 + zoom / 50) / 2)² = 1.
FILLS = 50.0 * (2.0 - 2.0**0.5)


def through_camera(session: Session) -> None:
    """The camera's frame fills the region, pixel by pixel."""
    render, region = session.scene.render, session.region
    render.resolution_x, render.resolution_y, render.resolution_percentage = region.width, region.height, 100
    session.view.view_perspective = "CAMERA"
    session.view.view_camera_zoom = FILLS
    session.view.view_camera_offset = (0.0, 0.0)


def render(session: Session, path: Path) -> None:
    """F12, with as many samples as the viewport."""
    ism = session.scene.ism
    for name in ("samples", "virtual_lights", "map_size", "map_points"):
        setattr(ism.render, name, getattr(ism.viewport, name))
    session.scene.render.filepath = str(path)
    session.scene.render.dither_intensity = 0.0  # the viewport has none
    with bpy.context.temp_override(window=session.window):
        bpy.ops.render.render(write_still=True)
