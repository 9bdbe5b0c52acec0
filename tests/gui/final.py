# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders by F12, and a viewport that shows the same pixels."""

from pathlib import Path

import bpy

from .session import Session

#: view_camera_zoom at which the camera's frame is as wide as the region: ((√2 + zoom / 50) / 2)² = 1.
FILL_ZOOM = 50.0 * (2.0 - 2.0**0.5)


def look_through_camera(session: Session) -> None:
    """Look through the camera, whose frame then fills the region: a pixel of the render is one of the region."""
    render, region = session.scene.render, session.region
    render.resolution_x, render.resolution_y, render.resolution_percentage = region.width, region.height, 100
    session.view.view_perspective = "CAMERA"
    session.view.view_camera_zoom = FILL_ZOOM
    session.view.view_camera_offset = (0.0, 0.0)


def render(session: Session, path: Path) -> None:
    """Render by F12 with the viewport's quality settings, and save the picture."""
    ism = session.scene.ism
    for name in ("samples", "virtual_lights", "map_size", "map_points"):
        setattr(ism.render, name, getattr(ism.viewport, name))
    session.scene.render.filepath = str(path)
    session.scene.render.dither_intensity = 0.0  # the viewport has none
    with bpy.context.temp_override(window=session.window):
        bpy.ops.render.render(write_still=True)
