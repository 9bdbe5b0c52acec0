# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps the texels of large images in temporary files, on Linux.

They are needed again only if textures are made anew. So the process has them in its memory only while they are read or
uploaded, besides the driver's copy. The system keeps files in memory that nothing else needs.
"""

import math
import mmap
import os
import tempfile

import numpy as np

#: Smaller arrays are kept in memory.
MIN_FILE_BYTES = 1 << 23


def empty(shape: tuple[int, ...], dtype: np.dtype) -> np.ndarray:
    """A new array, in a temporary file without a name if it is large, there is room for it, and the system can."""
    size = math.prod(shape) * dtype.itemsize
    if size >= MIN_FILE_BYTES and hasattr(os, "posix_fallocate"):
        try:
            with tempfile.TemporaryFile() as file:
                os.posix_fallocate(file.fileno(), 0, size)  # otherwise a full disk would end the process later
                return np.memmap(file, dtype, "r+", shape=shape)
        except OSError:
            pass
    return np.empty(shape, dtype)


def release_memory(array: np.ndarray) -> None:
    """Give back the memory of an array that is in a file. It is read from the file again where it is next accessed."""
    owner: object = array
    while isinstance(owner, np.ndarray):
        owner = owner.base
    if isinstance(owner, mmap.mmap):
        owner.madvise(mmap.MADV_DONTNEED)
