# SPDX-License-Identifier: GPL-3.0-or-later
"""The OpenGL context: draws do not block other Python threads."""

import math
import sys
import time
from threading import Event, Thread

import numpy as np

from ism_addon.gpu.gl.shader_compiler import compile_program
from ism_addon.gpu.gl.shader_records import INSTANCE


def ticks_during(draw) -> int:
    """How often another thread that does not wait for the GIL ran while something was drawn; inf if that took 10 ms."""
    ticks, done = [], Event()

    def count_ticks() -> None:
        while not done.wait(1e-4):
            ticks.append(1)

    other, interval = Thread(target=count_ticks), sys.getswitchinterval()
    sys.setswitchinterval(100.0)  # so that no thread is forced to release the GIL
    try:
        other.start()
        before, start = len(ticks), time.perf_counter()
        draw()
        after, seconds = len(ticks), time.perf_counter() - start
    finally:
        sys.setswitchinterval(interval)
        done.set()
        other.join()
    return after - before if seconds >= 0.01 else math.inf


def test_other_threads_run_while_triangles_are_drawn(device):
    """Software drivers draw before the call returns. The GIL must not be held for so long. Cards return at once."""
    names = "glsl/instances.vert", "passes/surfaces/visibility_buffer.frag"
    program = compile_program(device, *names, records=(INSTANCE,), reversed_depth=1)
    triangles = device.gl.vertex_array(program, [])
    device.gl.simple_framebuffer((8, 8)).use()
    ticks = ticks_during(lambda: device.draw(triangles, 0, 2_000_000, 1))
    device.wait()
    assert ticks > 1


def test_other_threads_run_while_a_program_draws_first(device):
    """Software drivers compile it then, unless they have it on disk."""
    new = time.time_ns() % 10**9
    cosines = "".join(f"color = cos(color.yzxw + {k}.0 * tan(color.x)) + sqrt(abs(color));\n" for k in range(200))
    program = device.gl.program(
        "#version 410 core\nin vec2 at; void main() { gl_Position = vec4(at, 0.0, 1.0); }",
        fragment_shader="#version 410 core\nout vec4 color;\n"
        f"void main() {{ color = gl_FragCoord + {new}e-9;\n{cosines} }}",
    )
    device.gl.simple_framebuffer((8, 8)).use()
    ticks = ticks_during(lambda: device.points.draw(program, np.zeros((1, 2), np.float32), ("2f", "at")))
    device.wait()
    assert ticks > 1
