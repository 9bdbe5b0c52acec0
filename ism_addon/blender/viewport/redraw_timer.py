# SPDX-License-Identifier: GPL-3.0-or-later
"""A timer in Blender's main loop that redraws viewports when there is a new picture for them.

Blender's redraw of a window and our passes compete for the processor or the graphics card. When both run at the same
time, each takes twice as long, and the window is frozen meanwhile. So the render thread pauses while Blender draws.
"""

import time
from typing import Protocol
from weakref import WeakSet

import bpy

from ...gpu.jobs.render_thread import shared
from ..render import render_statistics

POLL_INTERVAL = 0.01  # s between checks for a new picture
IDLE_POLL_INTERVAL = 0.002  # s between checks whether the render thread is idle
MAX_IDLE_WAIT = 0.5  # s that a new picture waits for an idle thread; the longest pass is the first after the preview
MAX_PAUSE = 1.0  # s; if a redraw takes longer or never happens, the render thread continues


class Viewport(Protocol):
    """What the timer needs of a viewport."""

    @property
    def has_update(self) -> bool:
        """Whether there is a later picture than the one that it shows."""

    @property
    def is_rendering(self) -> bool:
        """Whether its job is running."""

    @property
    def statistics(self) -> dict:
        """Statistics of the latest picture."""


_viewports: "WeakSet[Viewport]" = WeakSet()


class _Timer:
    """Three steps: pause the render thread, redraw the viewports, resume the thread."""

    def __init__(self) -> None:
        self.paused_since: float | None = None  # s, monotonic; None: the render thread is not paused
        self.is_drawing = False  # viewports are tagged; Blender has drawn them when the timer is called next

    def __call__(self) -> float | None:
        if self.is_drawing:
            shared.resume()
            self.is_drawing, self.paused_since = False, None
        elif self.paused_since is None and any(viewport.has_update for viewport in _viewports):
            shared.pause(MAX_PAUSE)
            self.paused_since = time.monotonic()
        if self.paused_since is not None:
            if not shared.is_idle and time.monotonic() < self.paused_since + MAX_IDLE_WAIT:
                return IDLE_POLL_INTERVAL
            redraw_viewports()
            self.is_drawing = True
            return 0.0
        return POLL_INTERVAL if any(viewport.is_rendering or viewport.has_update for viewport in _viewports) else None


_timer = _Timer()


def watch(viewport: Viewport) -> None:
    """Poll this viewport too, as long as it exists."""
    _viewports.add(viewport)


def start_timer() -> None:
    """Poll until no viewport is rendering."""
    if not bpy.app.timers.is_registered(_timer):
        bpy.app.timers.register(_timer, first_interval=POLL_INTERVAL)


def stop_timer() -> None:
    """Stop polling."""
    if bpy.app.timers.is_registered(_timer):
        bpy.app.timers.unregister(_timer)


def redraw_viewports() -> None:
    """Store the statistics of new pictures and redraw the viewports; when all are done, also the statistics panel."""
    for viewport in _viewports:
        if viewport.has_update:
            render_statistics.store("viewport", viewport.statistics)
    redraw(also_properties=not any(viewport.is_rendering for viewport in _viewports))


def redraw(also_properties: bool = False) -> None:
    """Redraw all viewports in Rendered shading, and the properties editors if requested."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D" and area.spaces.active.shading.type == "RENDERED":
                for region in area.regions:
                    if region.type == "WINDOW":  # not its header and sidebars
                        region.tag_redraw()
            elif also_properties and area.type == "PROPERTIES":
                area.tag_redraw()
