# SPDX-License-Identifier: GPL-3.0-or-later
"""When a renderer waits for the GPU, and how long its passes take.

A short sample is submitted at once, and waited for after the next one has been submitted, so that the GPU never idles.
During a long sample the renderer waits after each pass, and within a pass after each portion. Otherwise the sample
could not be cancelled, and drivers with a full queue would block within a draw, which holds Python's lock (GIL).
"""

import time
from collections import deque
from collections.abc import Callable

from .gl import draw_limit
from .gl.context import Device
from .gl.errors import Cancelled
from .profile import PassProfile

#: Duration of a short sample, s. A render that is cancelled, or whose scene is edited, waits for two of them at most.
SHORT_SAMPLE = 0.03


def never() -> bool:
    """`cancelled` of renders that cannot be cancelled."""
    return False


class Submission:
    """The submissions of one renderer."""

    def __init__(self, device: Device):
        self.device = device
        self._was_short = False
        self._synchronous = True
        self._begun = 0.0
        self._cancelled: Callable[[], bool] = never
        #: Cost of the draws since the last submission.
        self._rays = 0.0
        #: Timer queries of short samples in flight: one before the first pass, and one after each pass, with its row.
        #: Time in which the GPU waits for Python counts for the next pass.
        self._timestamps: deque[list[tuple[PassProfile, int]]] = deque()

    def begin(self, sample: int, cancelled: Callable[[], bool]) -> None:
        """Begin a sample. It waits after each pass if it is the first one, whose duration is unknown, or a long one."""
        self._cancelled = cancelled
        self._synchronous = sample == 0 or not (self._was_short and self.device.clock.is_available)
        self._rays, self._begun = 0.0, time.perf_counter()
        if not self._synchronous:
            self._timestamps.append([(PassProfile(), self.device.clock.record())])

    def before_draw(self, rays: float) -> None:
        """Call before a draw that takes the time of `rays` rays. Submits earlier draws if the sum exceeds the limit.

        Raises Cancelled.
        """
        if self._synchronous and self._rays + rays > draw_limit.MAX_RAYS_PER_DRAW:
            self.submit()
        self._rays += rays

    def submit(self) -> None:
        """See Device.submit. Raises Cancelled."""
        self.device.submit()
        self._rays = 0.0
        self.check_cancelled()

    def check_cancelled(self) -> None:
        """Raises Cancelled if the render is cancelled. For long work without draws."""
        if self._cancelled():
            raise Cancelled

    def end_pass(self, row: PassProfile, begun: float) -> None:
        """A pass that began at `begun` (s, perf_counter) is submitted: add its time to this row."""
        if self._synchronous:
            self.device.wait()
            self._rays = 0.0
            row.ms += 1e3 * (time.perf_counter() - begun)
        else:
            self._timestamps[-1].append((row, self.device.clock.record()))

    def end(self) -> None:
        """End a sample."""
        if self._synchronous:
            self.finish()
        else:
            self.device.submit()
            self._read_times(1)
        self._was_short = time.perf_counter() - self._begun < SHORT_SAMPLE

    def finish(self) -> None:
        """Wait for all submissions."""
        self._synchronous = True
        self.device.wait()
        self._read_times(0)

    def _read_times(self, in_flight: int) -> None:
        """Add the times of passes to their rows, except those of the newest `in_flight` samples."""
        while len(self._timestamps) > in_flight:
            timestamps = self._timestamps.popleft()
            times = [self.device.clock.read(query) for _, query in timestamps]
            for (row, _), earlier, later in zip(timestamps[1:], times, times[1:], strict=False):
                row.ms += later - earlier
