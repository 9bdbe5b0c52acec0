# SPDX-License-Identifier: GPL-3.0-or-later
"""The status tells how many shaders have been compiled: some drivers take a second for each."""

import threading
import time

from ism_addon.gpu.gl import shader_compiler
from ism_addon.gpu.jobs.job import COMPILING_SHOWN_EVERY, Job, Request
from ism_addon.gpu.jobs.render_loop import RenderLoop
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS


def new_job() -> Job:
    return Job(Request(*box_over_plane(24, 16), SMALL_SETTINGS), threading.Condition())


def test_the_status_counts_shaders_while_they_are_compiled(device, monkeypatch):
    """The status shows the count when a program's compilation begins, and the samples again once its pass is drawn."""
    loop, original, statuses = RenderLoop(device, 0), shader_compiler.compile_stages, []
    device.forget_programs()
    for _ in range(2):
        job = new_job()

        def compile_stages(*args, job=job):
            statuses.append(job.status)
            return original(*args)

        monkeypatch.setattr(shader_compiler, "compile_stages", compile_stages)
        while not job.finished:
            loop.step("client", job)
            assert job.status.startswith("Sample")
        assert job.error == ""
    assert statuses == [f"Compiling shaders ({number})" for number in range(1, len(device.programs) + 1)]
    loop.forget("client")


def test_viewports_show_it_at_most_twice_a_second():
    job = new_job()
    for _ in range(3):
        job.begin_program()
    assert job.programs_shown == 0
    time.sleep(COMPILING_SHOWN_EVERY)
    for _ in range(3):
        job.begin_program()
    assert (job.programs, job.programs_shown) == (6, 4)
