# SPDX-License-Identifier: GPL-3.0-or-later
"""Atomic writing of files: completely or not at all, if their folder allows it."""

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from errno import EACCES, EROFS
from pathlib import Path
from typing import BinaryIO

#: Errors of folders in which no file may be created.
FORBIDDEN = EACCES, EROFS


@contextmanager
def atomic_write(path: str | Path) -> Iterator[BinaryIO]:
    """A file that replaces `path` when it has been written; if writing fails, `path` keeps its contents.

    In a folder where no other file may be created, `path` is overwritten. Raises OSError, which names `path`.
    """
    try:
        if os.path.exists(path) and not os.path.isfile(path):  # such as /dev/stdout
            with open(path, "wb") as file:
                yield file
        else:
            with _temporary_beside(Path(os.path.realpath(path))) as file:  # of a link, the target is replaced
                yield file
    except OSError as reason:
        raise OSError(reason.errno, reason.strerror or str(reason), str(path)) from reason


@contextmanager
def _temporary_beside(target: Path) -> Iterator[BinaryIO]:
    """A temporary file in the target's folder, which replaces the target. The target is a plain file or missing."""
    if target.exists() and not os.access(target, os.W_OK):
        raise OSError(EACCES, os.strerror(EACCES))
    # Random, not the process id: that is always the same in a container, and threads share it.
    temporary = target.with_name(f".{secrets.token_hex(8)}.temporary")
    try:
        file = open(temporary, "xb")  # noqa: SIM115 (it is removed whatever fails)
    except OSError as reason:
        if reason.errno not in FORBIDDEN or not target.exists():
            raise
        file = None
    if file is None:
        with open(target, "wb") as file:
            yield file
        return
    try:
        with file:
            yield file
            file.flush()
            os.fsync(file.fileno())  # without it, the file may be empty after a power cut
        if target.exists():
            shutil.copymode(target, temporary)
        os.replace(temporary, target)
    except BaseException:
        temporary.unlink()
        raise
