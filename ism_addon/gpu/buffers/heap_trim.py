# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory that numpy has done with, back to the system.

The GNU C library keeps what threads have freed, each thread's for itself: a tenth of all, after a large scene.
"""

import ctypes
import sys


def trim_heap() -> None:
    """Let go of what is free, where the C library is one that has to be asked."""
    if sys.platform == "linux" and hasattr(library := ctypes.CDLL(None), "malloc_trim"):
        library.malloc_trim(0)
