# SPDX-License-Identifier: GPL-3.0-or-later
"""Returns freed memory to the operating system.

The GNU C library keeps what each thread has freed for later use of that thread: a tenth of all memory, after a large
scene.
"""

import ctypes
import sys


def trim_heap() -> None:
    """Return freed memory, if the C library can be asked to."""
    if sys.platform == "linux" and hasattr(library := ctypes.CDLL(None), "malloc_trim"):
        library.malloc_trim(0)
