# SPDX-License-Identifier: GPL-3.0-or-later
"""A timer in Blender's main loop that should beat 100 times a second: its longest gap is how long the window froze."""

import time
from types import TracebackType
from typing import Self

import bpy

BEAT = 0.01  # s


class Heartbeat:
    """Beats as long as its with-block lasts."""

    def __init__(self) -> None:
        self.beats: list[float] = []
        self.lives = True

    def __enter__(self) -> Self:
        bpy.app.timers.register(self._beat, persistent=True)
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.lives = False

    @property
    def longest_gap(self) -> float:
        """Seconds between two beats, at most."""
        return max((after - before for before, after in zip(self.beats, self.beats[1:], strict=False)), default=0.0)

    def _beat(self) -> float | None:
        self.beats.append(time.perf_counter())
        return BEAT if self.lives else None
