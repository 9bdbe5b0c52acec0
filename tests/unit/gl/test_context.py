# SPDX-License-Identifier: GPL-3.0-or-later
"""The OpenGL context: draws do not block other Python threads."""

import sys
import time
from threading import Event, Thread

from ism_addon.gpu.gl.shader_compiler import compile_program
from ism_addon.gpu.gl.shader_records import INSTANCE


def test_other_threads_run_while_triangles_are_drawn(device):
    """Software drivers draw before the call returns. The GIL must not be held for so long. Cards return at once."""
    names = "passes/surfaces/visibility_buffer.vert", "passes/surfaces/visibility_buffer.frag"
    program = compile_program(device, *names, records=(INSTANCE,), reversed_depth=1)
    triangles = device.gl.vertex_array(program, [])
    device.gl.simple_framebuffer((8, 8)).use()
    ticks, done = [], Event()

    def count_ticks() -> None:
        while not done.wait(1e-4):
            ticks.append(1)

    other, interval = Thread(target=count_ticks), sys.getswitchinterval()
    sys.setswitchinterval(100.0)  # so that no thread is forced to release the GIL
    try:
        other.start()
        before, start = len(ticks), time.perf_counter()
        device.draw(triangles, 0, 2_000_000, 1)
        after, seconds = len(ticks), time.perf_counter() - start
    finally:
        sys.setswitchinterval(interval)
        done.set()
        other.join()
    device.wait()
    assert after > before + 1 or seconds < 0.01
