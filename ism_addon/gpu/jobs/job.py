# SPDX-License-Identifier: GPL-3.0-or-later
"""A request to render, and its progress."""

import math
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ...render_passes import COMBINED, OCCLUSION, RenderPass
from ...scene import Scene, View
from ...setting_limits import view_within_limits, within_limits
from ...settings import Settings

#: Minimum of seconds between redraws that show the number of compiled shaders: each makes Blender draw its window.
COMPILING_SHOWN_EVERY = 0.5


@dataclass(frozen=True, eq=False)
class Request:
    """What to render."""

    scene: Scene
    view: View
    settings: Settings
    passes: tuple[RenderPass, ...] = (COMBINED,)  # the requested images
    preview_pixel_size: int = 0  # width of the first picture's pixels, in pixels; 0: no preview


@dataclass(frozen=True, eq=False)
class Picture:
    """The mean of `samples` samples; 0 samples: the preview. Bottom row first."""

    passes: Mapping[str, np.ndarray]  # (H,W,channels) float32 by the render pass's name
    samples: int

    @property
    def color(self) -> np.ndarray:
        """(H,W,4) float32 linear, alpha premultiplied."""
        return self.passes[COMBINED.name]


class Job:
    """The progress of one request. May be read from any thread."""

    def __init__(self, request: Request, changed: threading.Condition):
        view, settings = view_within_limits(request.view), within_limits(request.settings)
        settings = replace(settings, occlusion_pass=OCCLUSION in request.passes)
        self.request = replace(request, view=view, settings=settings)
        self.samples = self.request.settings.quality.samples  # upper limit; it grows where they leave much noise
        self.samples_done = 0
        self.progress = 0.0  # from 0 to 1; it never falls
        self.first_seconds = 0.0  # of the passes that drew the first picture's pixels; 0 before it is done
        self.finished = False
        self.cancelled = False
        self.error = ""
        self.statistics: dict = {}
        self.warnings: tuple[str, ...] = ()  # sentences about what could not be drawn
        self.compiles = False  # whether the current pass compiles shaders
        self.programs = 0  # compiled for this job; their final number is unknown
        self.programs_shown = 0  # `programs` as viewports show it
        self.graph, self.graphs = 0, 0  # whose programs are compiled, from 1, and how many there are; 0: none are
        self._shown_at = time.monotonic()
        self._changed = changed
        self._changes_seen = 0
        self._changes = 0
        self._picture: Picture | None = None

    @property
    def status(self) -> str:
        """For the user: samples done, and the estimated error."""
        if self.graphs:
            return f"Compiling shaders ({self.graph} of {self.graphs})"
        if self.compiles:
            return f"Compiling shaders ({self.programs})"
        error = self.statistics.get("error", math.inf)
        error_text = f", error {error:.1%}".replace("%", " %") if math.isfinite(error) else ""
        return f"Sample {self.samples_done}/{self.samples}{error_text}"

    def picture(self) -> Picture | None:
        """The latest picture. Until there is a later one, it is the same object."""
        return self._picture

    def wait(self, timeout: float) -> bool:
        """Wait for a change since the last call, or `timeout` seconds. Returns whether there was a change."""
        with self._changed:
            has_changed = self._changed.wait_for(lambda: self._changes != self._changes_seen or self.finished, timeout)
            self._changes_seen = self._changes
            return has_changed

    def cancel(self) -> None:
        """Stop after the current pass, or within it if it takes long."""
        self.cancelled = True

    def begin_program(self) -> None:
        """A program is about to be compiled. For the render thread."""
        self.notify(compiles=True, programs=self.programs + 1)
        if (now := time.monotonic()) - self._shown_at > COMPILING_SHOWN_EVERY:
            self.programs_shown, self._shown_at = self.programs, now

    def begin_graph(self, graph: int, graphs: int) -> None:
        """The programs of a graph, counted from 1, are about to be compiled; 0 of 0: all are. For the render thread."""
        self.notify(graph=graph, graphs=graphs)

    def notify(self, **changes: object) -> None:
        """Set attributes and wake waiting threads. For the render thread."""
        with self._changed:
            for name, value in changes.items():
                setattr(self, name, value)
            self._changes += 1
            self._changed.notify_all()
