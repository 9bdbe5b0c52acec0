# SPDX-License-Identifier: GPL-3.0-or-later
"""The OpenGL context, and what goes on beside it."""

import sys
from threading import Event, Thread

from ism_addon.gpu.gl.shader_compiler import compile_program
from ism_addon.gpu.gl.shader_records import INSTANCE


def test_other_threads_go_on_while_triangles_are_drawn(device):
    """Software drivers are at it until the call returns: the interpreter's lock is not held for so long."""
    names = "passes/surfaces/visibility_buffer.vert", "passes/surfaces/visibility_buffer.frag"
    program = compile_program(device, *names, records=(INSTANCE,), reversed_depth=1)
    triangles = device.gl.vertex_array(program, [])
    device.gl.simple_framebuffer((8, 8)).use()
    turns, done = [], Event()

    def take_turns() -> None:
        while not done.wait(1e-4):
            turns.append(1)

    other, interval = Thread(target=take_turns), sys.getswitchinterval()
    sys.setswitchinterval(100.0)  # nobody is made to let go of the lock
    try:
        other.start()
        before = len(turns)
        device.draw(triangles, 0, 2_000_000, 1)
        after = len(turns)
    finally:
        sys.setswitchinterval(interval)
        done.set()
        other.join()
    device.wait()
    assert after > before + 1
