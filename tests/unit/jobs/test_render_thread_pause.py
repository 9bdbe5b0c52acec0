# SPDX-License-Identifier: GPL-3.0-or-later
"""The render thread paused and stopped: nothing is drawn, and no memory is kept."""

import threading
import time

import numpy as np
import pytest

from ism_addon.gpu.jobs.render_thread import JOIN_TIMEOUT
from ism_addon.gpu.passes.film.shade import Shade
from tests.support.jobs import LONG, request, wait_for_end, wait_for_picture, wait_until
from tests.tools.memory import resident

pytestmark = pytest.mark.alone


def test_no_pass_begins_during_a_pause(worker):
    job = worker.start(request(LONG), "client")
    assert wait_for_picture(job)
    worker.pause(60.0)
    assert wait_until(lambda: worker.is_idle)
    done = job.samples_done
    time.sleep(0.1)
    assert job.samples_done == done
    worker.resume()
    assert wait_until(lambda: job.samples_done > done)
    assert not job.finished


def test_the_thread_is_idle_when_its_jobs_have_ended(worker):
    """Otherwise viewports would wait before they show the last picture."""
    assert wait_for_end(worker.start(request(), "client"))
    assert worker.is_idle
    job = worker.start(request(LONG), "client")
    assert wait_for_picture(job)
    assert not worker.is_idle


def test_a_pause_ends_after_its_time_and_when_the_worker_stops(worker):
    assert worker.is_idle
    worker.pause(0.2)
    assert wait_for_end(worker.start(request(), "client"), 5.0)
    worker.pause(60.0)
    job = worker.start(request(), "client")
    began = time.monotonic()
    worker.stop()
    assert time.monotonic() - began < 5.0
    assert job.finished
    assert worker.is_idle


def test_stop_does_not_wait_for_a_pass_that_hangs(worker, monkeypatch):
    """A driver may hang, and would block Blender's window. Other jobs are drawn meanwhile and afterwards."""
    stuck, released = threading.Event(), threading.Event()
    execute, hanging = Shade.execute, []

    def hang_once(own, frame):
        if not hanging:
            hanging.append(threading.current_thread())
            stuck.set()
            released.wait(60.0)
        execute(own, frame)

    monkeypatch.setattr(Shade, "execute", hang_once)
    job = worker.start(request(), "client")
    assert stuck.wait(30.0)
    began = time.monotonic()
    worker.stop()
    assert time.monotonic() - began < JOIN_TIMEOUT + 1.0
    assert job.finished
    later = worker.start(request(), "client")
    assert wait_for_end(later)
    assert later.error == ""
    released.set()
    hanging[0].join(10.0)
    assert not hanging[0].is_alive()
    assert wait_for_end(again := worker.start(request(), "client"))
    assert np.array_equal(again.picture().color, later.picture().color)


@pytest.mark.skipif(not resident(), reason="this system does not say how much memory a process has")
def test_stop_frees_all_memory(worker):
    """Also what drivers hold in main memory: with software OpenGL that is all of it."""
    sizes = []
    for _ in range(24):
        assert wait_for_end(worker.start(request(size=(640, 480)), "client"))
        worker.stop()
        sizes.append(resident())
    # The allocator keeps a varying amount, more over the first repetitions, and once gave 80 MB back; a leaked context
    # would be 60 MB in each, 480 between these medians.
    assert np.median(sizes[16:]) - np.median(sizes[8:16]) < 60e6
