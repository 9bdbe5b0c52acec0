# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are written whole or not at all."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from errno import EACCES
from pathlib import Path
from typing import BinaryIO


@contextmanager
def replacing(path: str | Path) -> Iterator[BinaryIO]:
    """A file that takes the place of `path` when all has been written; if that fails, what was there before stays.

    Raises OSError, which names `path`.
    """
    try:
        if os.path.exists(path) and not os.path.isfile(path):  # such as /dev/stdout
            with open(path, "wb") as file:
                yield file
        else:
            with _beside(Path(os.path.realpath(path))) as file:  # where a link leads, the link stays
                yield file
    except OSError as reason:
        raise OSError(reason.errno, reason.strerror or str(reason), str(path)) from reason


@contextmanager
def _beside(place: Path) -> Iterator[BinaryIO]:
    """The same for a plain file, or none so far."""
    if place.exists() and not os.access(place, os.W_OK):
        raise OSError(EACCES, os.strerror(EACCES))
    part = place.with_name(f".{os.getpid()}.part")
    file = open(part, "xb")  # noqa: SIM115 (what another one has begun is not to be removed)
    try:
        with file:
            yield file
        if place.exists():
            shutil.copymode(place, part)
        os.replace(part, place)
    except BaseException:
        part.unlink()
        raise
