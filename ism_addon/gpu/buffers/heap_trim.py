# SPDX-License-Identifier: GPL-3.0-or-later
"""Returns freed memory to the operating system.

The GNU C library keeps memory that a thread has freed, for later use by that thread. After a large scene, that is a
tenth of all memory.
"""

import ctypes
import sys


def trim_heap() -> None:
    """Return freed memory, if the C library has a function for it."""
    if sys.platform == "linux" and hasattr(library := ctypes.CDLL(None), "malloc_trim"):
        library.malloc_trim(0)
