# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in parts, side by side on all of the processor's cores: numpy lets go of the interpreter's lock."""

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

#: Work on fewer things than this is done sooner than threads are started.
LARGE = 1 << 14

Part = TypeVar("Part")
Made = TypeVar("Made")


def parallel_map(work: Callable[[Part], Made], parts: Iterable[Part], size: int) -> list[Made]:
    """What `work` makes of each part, in their order, of `size` things in all."""
    if size <= LARGE:
        return [work(part) for part in parts]
    with ThreadPoolExecutor() as cores:
        return list(cores.map(work, parts))
