# SPDX-License-Identifier: GPL-3.0-or-later
"""A process forked as by multiprocessing on Linux: it draws, or its job has an error that says why it cannot."""

import os
import subprocess
import sys

import pytest

from tests.tools.project import ROOT

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")

#: drawn(): the error of a job, or its mean colour. child(function): what it returns in a child process, within 20 s.
SCRIPT = """
import os, signal, time
from ism_addon.gpu.jobs.render_thread import shared
from tests.support.jobs import LONG, request, wait_for_end, wait_for_picture
def drawn():
    job = shared.start(request(), "client")
    assert wait_for_end(job)
    return job.error or f"{job.picture().color.mean():.6f}"
def child(function):
    read_end, write_end = os.pipe()
    pid = os.fork()
    if not pid:
        signal.alarm(20)
        os.write(write_end, function().encode())
        os._exit(0)
    assert os.waitpid(pid, 0)[1] == 0, "the child did not exit normally"
    return os.read(read_end, 1000).decode()
"""


def output(*lines: str) -> list[str]:
    """Lines that SCRIPT, followed by these lines, prints."""
    command = [sys.executable, "-c", "\n".join([SCRIPT, *lines, "shared.stop()"])]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert run.returncode == 0, run.stderr
    return run.stdout.splitlines()


def test_a_child_of_a_process_that_has_drawn_nothing_draws():
    child, parent = output("print(child(drawn))", "print(drawn())")
    assert child == parent
    assert float(child) > 0.0


def test_a_child_of_a_process_that_has_drawn_says_why_it_cannot():
    parent, child, again = output("print(drawn())", "print(child(drawn))", "print(drawn())")
    assert child.startswith("OpenGL does not outlive a fork")
    assert parent == again


def test_a_running_job_ends_in_the_child():
    """It goes on in the parent."""
    lines = (
        "job = shared.start(request(LONG), 'client')",
        "assert wait_for_picture(job)",
        "print(child(lambda: job.error if wait_for_end(job) else 'it did not end'))",
        "done = job.samples_done",
        "deadline = time.monotonic() + 20.0",
        "while job.samples_done <= done and time.monotonic() < deadline: job.wait(1.0)",
        "print(job.samples_done > done and not job.finished)",
    )
    assert output(*lines) == ["The picture is drawn by the process that this one was forked from", "True"]
