# SPDX-License-Identifier: GPL-3.0-or-later
"""A timer in Blender's main loop that has viewports drawn again when there is a new picture for them.

Blender's redraw of a window and our passes want the same processor, or the same graphics card: side by side each takes
twice as long, and the window is stuck for all of it. So the worker rests as long as Blender draws.
"""

from typing import Protocol
from weakref import WeakSet

import bpy

from ...gpu.jobs.render_thread import shared
from ..render import render_statistics

LOOK_EVERY = 0.01  # s: how long a new picture can go unnoticed
STILL_EVERY = 0.002  # s: how long it can go unnoticed that the worker rests
PATIENCE = 0.5  # s: so long at most a new picture waits for that; the longest pass is the first with finer pixels
REST = 1.0  # s: a redraw that takes longer, or never comes, does not keep the worker from its work


class Viewport(Protocol):
    """What is looked at."""

    @property
    def has_news(self) -> bool:
        """Whether there is a better picture than the one that it shows."""

    @property
    def is_waiting(self) -> bool:
        """Whether there will be."""

    @property
    def statistics(self) -> dict:
        """Of the latest picture."""


_alive: "WeakSet[Viewport]" = WeakSet()


class _Timer:
    """Three steps: let the worker rest, have the windows drawn, let it go on."""

    def __init__(self) -> None:
        self.waited: float | None = None  # s for the worker to rest; None if it was not asked to
        self.draws = False  # Blender has been asked to, and has done so when the timer comes next

    def __call__(self) -> float | None:
        if self.draws:
            shared.resume()
            self.draws, self.waited = False, None
        elif self.waited is None and any(viewport.has_news for viewport in _alive):
            shared.pause(REST)
            self.waited = 0.0
        if self.waited is not None:
            if not shared.is_idle and self.waited < PATIENCE:
                self.waited += STILL_EVERY
                return STILL_EVERY
            redraw_viewports()
            self.draws = True
            return 0.0
        return LOOK_EVERY if any(viewport.is_waiting or viewport.has_news for viewport in _alive) else None


_timer = _Timer()


def watch(viewport: Viewport) -> None:
    """Look at this viewport too, as long as it lives."""
    _alive.add(viewport)


def start_timer() -> None:
    """Look from now on, until there is nothing more to come."""
    if not bpy.app.timers.is_registered(_timer):
        bpy.app.timers.register(_timer, first_interval=LOOK_EVERY)


def stop_timer() -> None:
    """Look no more."""
    if bpy.app.timers.is_registered(_timer):
        bpy.app.timers.unregister(_timer)


def redraw_viewports() -> None:
    """Have drawn what shows the news, and at the end what they took."""
    for viewport in _alive:
        if viewport.has_news:
            render_statistics.store("viewport", viewport.statistics)
    redraw(also_properties=not any(viewport.is_waiting for viewport in _alive))


def redraw(also_properties: bool = False) -> None:
    """Draw all viewports in Rendered shading again, and perhaps the properties, whose statistics they are."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D" and area.spaces.active.shading.type == "RENDERED":
                for region in area.regions:
                    if region.type == "WINDOW":  # its header and sidebars have no news
                        region.tag_redraw()
            elif also_properties and area.type == "PROPERTIES":
                area.tag_redraw()
