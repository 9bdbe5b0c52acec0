# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are written whole or not at all."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO


@contextmanager
def replacing(path: str | Path) -> Iterator[BinaryIO]:
    """A file that takes the place of `path` when all has been written; if that fails, what was there before stays.

    Raises OSError, which names `path`.
    """
    place = Path(path).resolve()  # where a link leads, the link stays
    if place.exists() and not place.is_file():  # such as /dev/stdout
        with open(place, "wb") as file:
            yield file
        return
    part = place.with_name(f"{place.name}.part")
    try:
        with open(part, "wb") as file:
            yield file
        os.replace(part, place)
    except OSError as reason:
        raise OSError(reason.errno, reason.strerror or str(reason), str(path)) from reason
    finally:
        part.unlink(missing_ok=True)
