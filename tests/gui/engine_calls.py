# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks over the engine's shoulder in Blender's main thread: when it is called, for how long, and what it has drawn."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gpu
import numpy as np

PATCH = 24  # pixels: width and height of what is looked at


@dataclass(frozen=True)
class Call:
    """One call of the engine by Blender."""

    name: str
    began: float
    ended: float
    seen: np.ndarray | None  # (3,) mean colour of the patch after it


class EngineCalls:
    """Wraps the engine's methods that a viewport calls."""

    def __init__(self, engine_class: Any):
        self.calls: list[Call] = []
        self.place: tuple[float, float] | None = None  # of the patch's middle, as parts of the region, from below left
        for name in ("view_update", "view_draw"):
            setattr(engine_class, name, self._watched(name, getattr(engine_class, name)))

    def redraws(self, since: float) -> int:
        """How often the engine drew."""
        return sum(call.name == "view_draw" for call in self._after(since))

    def longest_redraw(self, since: float) -> float:
        """Seconds that one redraw held the main thread for at most, with the updates before it."""
        longest = held = 0.0
        for call in self._after(since):
            held += call.ended - call.began
            if call.name == "view_draw":
                longest, held = max(longest, held), 0.0
        return longest

    def longest_update(self, since: float) -> float:
        """Seconds that the longest call of view_update took."""
        return max((call.ended - call.began for call in self._after(since) if call.name == "view_update"), default=0.0)

    def patch_colors(self, since: float) -> list[Call]:
        """The calls after which the patch was looked at."""
        return [call for call in self._after(since) if call.seen is not None]

    def _after(self, since: float) -> list[Call]:
        return [call for call in self.calls if call.began >= since]

    def _watched(self, name: str, method: Callable) -> Callable:
        def watched(engine: Any, context: Any, depsgraph: Any) -> None:
            began = time.perf_counter()
            method(engine, context, depsgraph)
            ended = time.perf_counter()
            look = name == "view_draw" and self.place is not None
            seen = _mean_color(context.region, self.place) if look else None
            self.calls.append(Call(name, began, ended, seen))

        return watched


def _mean_color(region: Any, place: tuple[float, float]) -> np.ndarray:
    left, bottom = (
        round(part * length) - PATCH // 2 for part, length in zip(place, (region.width, region.height), strict=True)
    )
    framebuffer = gpu.state.active_framebuffer_get()
    pixels = framebuffer.read_color(left, bottom, PATCH, PATCH, 3, 0, "FLOAT")
    pixels.dimensions = PATCH * PATCH * 3
    return np.array(pixels).reshape(-1, 3).mean(axis=0)
