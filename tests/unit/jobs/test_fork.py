# SPDX-License-Identifier: GPL-3.0-or-later
"""A process that was forked, as multiprocessing does it on Linux: it draws, or says why it cannot."""

import os
import subprocess
import sys

import pytest

from tests.tools.project import ROOT

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")

#: drawn(): what becomes of a job; child(function): what it says in a child, which ends if that takes too long.
SCRIPT = """
import os, signal, time
from ism_addon.gpu.jobs.render_thread import shared
from tests.support.jobs import LONG, begun, ended, request
def drawn():
    job = shared.start(request(), "client")
    assert ended(job)
    return job.error or f"{job.picture().color.mean():.6f}"
def child(function):
    reads, writes = os.pipe()
    number = os.fork()
    if not number:
        signal.alarm(20)
        os.write(writes, function().encode())
        os._exit(0)
    assert os.waitpid(number, 0)[1] == 0, "the child did not come to an end"
    return os.read(reads, 1000).decode()
"""


def said(*lines: str) -> list[str]:
    command = [sys.executable, "-c", "\n".join([SCRIPT, *lines, "shared.stop()"])]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert run.returncode == 0, run.stderr
    return run.stdout.splitlines()


def test_a_child_of_a_process_that_has_drawn_nothing_draws():
    child, parent = said("print(child(drawn))", "print(drawn())")
    assert child == parent
    assert float(child) > 0.0


def test_a_child_of_a_process_that_has_drawn_says_why_it_cannot():
    parent, child, again = said("print(drawn())", "print(child(drawn))", "print(drawn())")
    assert child.startswith("OpenGL does not outlive a fork")
    assert parent == again


def test_a_job_that_was_under_way_ends_in_the_child():
    """And goes on in the parent."""
    lines = (
        "job = shared.start(request(LONG), 'client')",
        "assert begun(job)",
        "print(child(lambda: job.error if ended(job) else 'it did not end'))",
        "done = job.samples_done",
        "deadline = time.monotonic() + 20.0",
        "while job.samples_done <= done and time.monotonic() < deadline: job.wait(1.0)",
        "print(job.samples_done > done and not job.finished)",
    )
    assert said(*lines) == ["The picture is drawn by the process that this one was forked from", "True"]
