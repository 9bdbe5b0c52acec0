# SPDX-License-Identifier: GPL-3.0-or-later
"""Requests to the render thread, and functions that wait for their results."""

import time
from collections.abc import Callable

from ism_addon.gpu.jobs.job import Job, Request
from ism_addon.render_passes import RENDER_PASSES
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS, with_quality

#: More samples than any test waits for.
LONG = with_quality(SMALL_SETTINGS, samples=60_000)


def request(settings=SMALL_SETTINGS, make=box_over_plane, size=(24, 16)) -> Request:
    return Request(*make(*size), settings, RENDER_PASSES)


def wait_for_end(job: Job, limit: float = 30.0) -> bool:
    """Wait up to `limit` s for the job's end. Returns whether it ended."""
    deadline = time.monotonic() + limit
    while not job.finished and time.monotonic() < deadline:
        job.wait(0.5)
    return job.finished


def wait_until(happened: Callable[[], bool], limit: float = 30.0) -> bool:
    """Wait up to `limit` s. Returns whether it happened."""
    deadline = time.monotonic() + limit
    while not happened() and time.monotonic() < deadline:
        time.sleep(0.001)
    return happened()


def wait_for_picture(job: Job) -> bool:
    """Wait for the job's first picture. Returns whether there is one."""
    deadline = time.monotonic() + 30.0
    while job.picture() is None and not job.finished and time.monotonic() < deadline:
        job.wait(0.5)
    return job.picture() is not None
