# SPDX-License-Identifier: GPL-3.0-or-later
"""Records when Blender calls the engine in its main thread, for how long, and the colour of a patch it has drawn."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gpu
import numpy as np

PATCH_SIZE = 24  # pixels: width and height of the patch


@dataclass(frozen=True)
class Call:
    """One call of the engine by Blender."""

    name: str
    began: float
    ended: float
    patch_color: np.ndarray | None  # (3,) mean of the patch after the call; None: not read


class EngineCalls:
    """Wraps the engine's methods that a viewport calls, and records each call."""

    def __init__(self, engine_class: Any):
        self.calls: list[Call] = []
        self.patch_uv: tuple[float, float] | None = None  # the patch's middle in the region; None: no patch is read
        self._engine_class = engine_class
        self._methods = {name: getattr(engine_class, name) for name in ("view_update", "view_draw")}
        for name, method in self._methods.items():
            setattr(engine_class, name, self._recorded(name, method))

    def release(self) -> None:
        """Record no further calls."""
        for name, method in self._methods.items():
            setattr(self._engine_class, name, method)

    def redraws(self, since: float) -> int:
        """How often the engine has drawn."""
        return sum(call.name == "view_draw" for call in self._after(since))

    def longest_redraw(self, since: float) -> float:
        """Seconds for which one redraw and the updates before it have blocked the main thread, at most."""
        longest = blocked = 0.0
        for call in self._after(since):
            blocked += call.ended - call.began
            if call.name == "view_draw":
                longest, blocked = max(longest, blocked), 0.0
        return longest

    def longest_update(self, since: float) -> float:
        """Seconds that the longest call of view_update took."""
        return max((call.ended - call.began for call in self._after(since) if call.name == "view_update"), default=0.0)

    def patch_colors(self, since: float) -> list[Call]:
        """The calls that have a `patch_color`."""
        return [call for call in self._after(since) if call.patch_color is not None]

    def _after(self, since: float) -> list[Call]:
        return [call for call in self.calls if call.began >= since]

    def _recorded(self, name: str, method: Callable) -> Callable:
        def recorded(engine: Any, context: Any, depsgraph: Any) -> None:
            began = time.perf_counter()
            method(engine, context, depsgraph)
            ended = time.perf_counter()
            has_patch = name == "view_draw" and self.patch_uv is not None
            patch_color = _mean_color(context.region, self.patch_uv) if has_patch else None
            self.calls.append(Call(name, began, ended, patch_color))

        return recorded


def _mean_color(region: Any, uv: tuple[float, float]) -> np.ndarray:
    """(3,) of the patch around (u, v)."""
    left, bottom = (
        round(fraction * length) - PATCH_SIZE // 2
        for fraction, length in zip(uv, (region.width, region.height), strict=True)
    )
    framebuffer = gpu.state.active_framebuffer_get()
    pixels = framebuffer.read_color(left, bottom, PATCH_SIZE, PATCH_SIZE, 3, 0, "FLOAT")
    pixels.dimensions = PATCH_SIZE * PATCH_SIZE * 3
    return np.array(pixels).reshape(-1, 3).mean(axis=0)
