# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a program on a screen of its own: desktop.py WIDTHxHEIGHT program arguments. Exits as the program does.

The screen is Xvfb's, with the window manager openbox if it is installed. Without Xvfb, it is that of DISPLAY.
"""

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def screen(size: str) -> Iterator[None]:
    """Set DISPLAY to a new screen of that size inside this with-block."""
    if shutil.which("Xvfb") is None:
        if "DISPLAY" not in os.environ:
            sys.exit("There is no DISPLAY, and no Xvfb that could make one.")
        yield
        return
    reader, writer = os.pipe()
    command = ["Xvfb", "-displayfd", str(writer), "-screen", "0", f"{size}x24", "+extension", "GLX", "-nolisten", "tcp"]
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    programs = [subprocess.Popen(command, pass_fds=[writer], **quiet)]
    os.close(writer)
    try:
        os.environ["DISPLAY"] = f":{os.read(reader, 16).decode().strip()}"  # written when the screen is ready
        if shutil.which("openbox"):
            programs.append(subprocess.Popen(["openbox"], **quiet))
        yield
    finally:
        os.close(reader)
        for program in reversed(programs):
            program.terminate()
            program.wait()


def main() -> int:
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    size, *command = sys.argv[1:]
    with screen(size):
        status = subprocess.run(command).returncode
    return status if status >= 0 else 128 - status


if __name__ == "__main__":
    sys.exit(main())
