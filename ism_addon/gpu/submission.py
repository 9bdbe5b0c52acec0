# SPDX-License-Identifier: GPL-3.0-or-later
"""When a renderer waits for the GPU, and how long its passes take.

A short sample is handed over whole, and waited for when the next one has been handed over as well: so the GPU is never
idle. A longer one is waited for pass by pass, and within a pass, portion by portion: else nobody could cancel it, and
drivers whose queues are full would wait within a draw, which holds the interpreter's lock.
"""

import time
from collections import deque
from collections.abc import Callable

from .gl import draw_limit
from .gl.context import Device
from .gl.errors import Cancelled
from .profile import PassProfile

#: A sample that takes less is short. s
SHORT_SAMPLE = 0.03


def never() -> bool:
    """Whether a picture is cancelled that nobody can cancel."""
    return False


class Submission:
    """Of one renderer."""

    def __init__(self, device: Device):
        self.device = device
        self._is_short = False
        self._waits = True
        self._begun = 0.0
        self._cancelled: Callable[[], bool] = never
        #: Of which the GPU has been asked since the last time that something was handed over.
        self._rays = 0.0
        #: Of short samples that the GPU may still be busy with: the clock's notes before their first pass, and after
        #: each one. Time in which the GPU waits for Python is the next pass's.
        self._notes: deque[list[tuple[PassProfile, int]]] = deque()

    def begin(self, sample: int, cancelled: Callable[[], bool]) -> None:
        """A sample begins, which is wanted until it is `cancelled`; nobody knows of the first one how long it takes."""
        self._cancelled = cancelled
        self._waits = sample == 0 or not (self._is_short and self.device.clock.runs)
        self._rays, self._begun = 0.0, time.perf_counter()
        if not self._waits:
            self._notes.append([(PassProfile(), self.device.clock.note())])

    def ask(self, rays: float) -> None:
        """A draw comes that takes the time of so many rays: what came before is handed over if both are too much.

        Raises Cancelled.
        """
        if self._waits and self._rays + rays > draw_limit.MAX_RAYS_PER_DRAW:
            self.submit()
        self._rays += rays

    def submit(self) -> None:
        """See Device.submit. Raises Cancelled if that is so."""
        self.device.submit()
        self._rays = 0.0
        self.look()

    def look(self) -> None:
        """Raises Cancelled if that is so: for those who work for long without a draw."""
        if self._cancelled():
            raise Cancelled

    def passed(self, row: PassProfile, begun: float) -> None:
        """A pass that began then (s, perf_counter) has been asked for, or is done: its time is for this row."""
        if self._waits:
            self.device.wait()
            self._rays = 0.0
            row.ms += 1e3 * (time.perf_counter() - begun)
        else:
            self._notes[-1].append((row, self.device.clock.note()))

    def end(self) -> None:
        """The sample ends."""
        if self._waits:
            self.finish()
        else:
            self.device.submit()
            self._settle(1)
        self._is_short = time.perf_counter() - self._begun < SHORT_SAMPLE

    def finish(self) -> None:
        """Wait for all that was asked for."""
        self._waits = True
        self.device.wait()
        self._settle(0)

    def _settle(self, under_way: int) -> None:
        """Tell the rows what their passes took, but those of so many samples that are under way."""
        while len(self._notes) > under_way:
            notes = self._notes.popleft()
            times = [self.device.clock.read(query) for _, query in notes]
            for (row, _), earlier, later in zip(notes[1:], times, times[1:], strict=False):
                row.ms += later - earlier
