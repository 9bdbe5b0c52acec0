# SPDX-License-Identifier: GPL-3.0-or-later
"""What is to be drawn, and what has come of it so far."""

import math
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ...render_passes import COMBINED, RenderPass
from ...scene import Scene, View
from ...setting_limits import view_within_limits, within_limits
from ...settings import Settings

#: s between two updates of a viewport that say how many shaders have been compiled: each makes Blender draw its window.
COMPILING_SHOWN_EVERY = 0.5


@dataclass(frozen=True, eq=False)
class Request:
    """What is to be drawn."""

    scene: Scene
    view: View
    settings: Settings
    passes: tuple[RenderPass, ...] = (COMBINED,)  # the images that are wanted
    coarse: int = 0  # px of the view along either side of one in the first picture, which comes the sooner; 0 if
    # nobody waits for that, but only for the last one


@dataclass(frozen=True, eq=False)
class Picture:
    """The average of `samples` samples, or of none the coarse first picture. Bottom row first."""

    passes: Mapping[str, np.ndarray]  # (H,W,channels) float32 by the render pass's name
    samples: int

    @property
    def color(self) -> np.ndarray:
        """(H,W,4) float32 linear, alpha premultiplied."""
        return self.passes[COMBINED.name]


class Job:
    """One request on its way. All of it may be asked from any thread."""

    def __init__(self, request: Request, news: threading.Condition):
        view, settings = view_within_limits(request.view), within_limits(request.settings)
        self.request = replace(request, view=view, settings=settings)
        self.samples = self.request.settings.quality.samples  # at most
        self.samples_done = 0
        self.first_seconds = 0.0  # that the pixels of the first picture took, as soon as there is one
        self.finished = False
        self.cancelled = False
        self.error = ""
        self.statistics: dict = {}
        self.compiles = False  # the pass that is being drawn
        self.programs = 0  # compiled for this job. How many it will need is not known: passes ask for them as they draw
        self.programs_shown = 0  # of them, when viewports should say it again
        self._shown_at = time.monotonic()
        self._news = news
        self._seen = 0
        self._happened = 0
        self._picture: Picture | None = None

    @property
    def status(self) -> str:
        """How far it is, and how far the picture is thought to be from its end."""
        if self.compiles:
            return f"Compiling shaders ({self.programs})"
        error = self.statistics.get("error", math.inf)
        told = f", error {error:.1%}".replace("%", " %") if math.isfinite(error) else ""
        return f"Sample {self.samples_done}/{self.samples}{told}"

    def picture(self) -> Picture | None:
        """The newest picture, the same object until there is a newer one."""
        return self._picture

    def wait(self, timeout: float) -> bool:
        """Until there is news since the last call, or `timeout` seconds: whether there was any."""
        with self._news:
            told = self._news.wait_for(lambda: self._happened != self._seen or self.finished, timeout)
            self._seen = self._happened
            return told

    def cancel(self) -> None:
        """Stop after the pass that is being drawn or, if that is a long one, within it."""
        self.cancelled = True

    def begin_program(self) -> None:
        """A program is going to be compiled. The worker's side."""
        self.tell(compiles=True, programs=self.programs + 1)
        if (now := time.monotonic()) - self._shown_at > COMPILING_SHOWN_EVERY:
            self.programs_shown, self._shown_at = self.programs, now

    def tell(self, **changes: object) -> None:
        """Set attributes and wake whoever waits. The worker's side."""
        with self._news:
            for name, value in changes.items():
                setattr(self, name, value)
            self._happened += 1
            self._news.notify_all()
