# SPDX-License-Identifier: GPL-3.0-or-later
"""A timer in Blender's main loop, due 100 times a second: its longest gap is how long the window was frozen."""

import time
from types import TracebackType
from typing import Self

import bpy

INTERVAL = 0.01  # s


class Heartbeat:
    """Runs during its with-block."""

    def __init__(self) -> None:
        self.beats: list[float] = []
        self.is_running = True

    def __enter__(self) -> Self:
        bpy.app.timers.register(self._beat, persistent=True)
        return self

    def __exit__(self, type_: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.is_running = False

    @property
    def longest_gap(self) -> float:
        """The most seconds between two beats."""
        return max((after - before for before, after in zip(self.beats, self.beats[1:], strict=False)), default=0.0)

    def _beat(self) -> float | None:
        self.beats.append(time.perf_counter())
        return INTERVAL if self.is_running else None
