# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are written whole or not at all, where their folder allows it."""

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from errno import EACCES, EROFS
from pathlib import Path
from typing import BinaryIO

#: What a folder answers in which nothing may be written.
FORBIDDEN = EACCES, EROFS


@contextmanager
def atomic_write(path: str | Path) -> Iterator[BinaryIO]:
    """A file that takes the place of `path` when all has been written; if that fails, what was there before stays.

    But a file in a folder in which no other may be made is written over. Raises OSError, which names `path`.
    """
    try:
        if os.path.exists(path) and not os.path.isfile(path):  # such as /dev/stdout
            with open(path, "wb") as file:
                yield file
        else:
            with _temporary_beside(Path(os.path.realpath(path))) as file:  # where a link leads, the link stays
                yield file
    except OSError as reason:
        raise OSError(reason.errno, reason.strerror or str(reason), str(path)) from reason


@contextmanager
def _temporary_beside(place: Path) -> Iterator[BinaryIO]:
    """The same for a plain file, or none so far."""
    if place.exists() and not os.access(place, os.W_OK):
        raise OSError(EACCES, os.strerror(EACCES))
    # By chance, not by the process's number: that is always the same in a container, and threads share it.
    part = place.with_name(f".{secrets.token_hex(8)}.part")
    try:
        file = open(part, "xb")  # noqa: SIM115 (whatever else fails, it is to be removed)
    except OSError as reason:
        if reason.errno not in FORBIDDEN or not place.exists():
            raise
        file = None
    if file is None:
        with open(place, "wb") as file:
            yield file
        return
    try:
        with file:
            yield file
            file.flush()
            os.fsync(file.fileno())  # else it may be empty after a power cut, and the older one gone
        if place.exists():
            shutil.copymode(place, part)
        os.replace(part, place)
    except BaseException:
        part.unlink()
        raise
