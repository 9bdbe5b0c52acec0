# SPDX-License-Identifier: GPL-3.0-or-later
"""Parallel work on all processor cores, for numpy functions, which release the GIL.

There are as many threads as cores. More wait for one another's steps in Python: mip levels then take a fifth longer.
Constants …_AT_A_TIME are sizes of portions of such work, chosen so that their arrays fit in a core's cache.
"""

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

#: Work on so few items takes less time than starting threads. See `dev.py bench constants` in docs/benchmarks.md.
MIN_PARALLEL_SIZE = 1 << 14

#: Results that wait for those before them, at most, where they are not wanted all at once.
MAX_WAITING = 4

Portion = TypeVar("Portion")
Result = TypeVar("Result")


def parallel_map(work: Callable[[Portion], Result], portions: Iterable[Portion], size: int) -> list[Result]:
    """The results of `work` on each portion, in order. `size`: number of items in all portions."""
    if size <= MIN_PARALLEL_SIZE:
        return [work(portion) for portion in portions]
    with ThreadPoolExecutor(os.cpu_count()) as cores:
        return list(cores.map(work, portions))


def parallel_results(work: Callable[[Portion], Result], portions: Iterable[Portion], size: int) -> Iterator[Result]:
    """As parallel_map, one result after the other: only few are kept in memory."""
    if size <= MIN_PARALLEL_SIZE:
        yield from map(work, portions)
        return
    with ThreadPoolExecutor(os.cpu_count()) as cores:
        waiting = deque[Future[Result]]()
        for portion in portions:
            waiting.append(cores.submit(work, portion))
            if len(waiting) == MAX_WAITING:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
