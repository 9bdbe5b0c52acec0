# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics of the latest picture of each use, "render" or "viewport"."""

from copy import deepcopy

_kept: dict[str, dict] = {}


def store(use: str, statistics: dict) -> None:
    """Store the statistics of a picture, unless they are empty because its job has drawn nothing yet."""
    if statistics:
        _kept.pop(use, None)
        _kept[use] = statistics


def for_use(use: str) -> dict:
    """A copy of the statistics of a use; {} before the first picture."""
    return deepcopy(_kept.get(use, {}))


def latest() -> tuple[str, dict]:
    """The use of the latest picture, and a copy of its statistics; "" and {} before the first."""
    use = next(reversed(_kept), "")
    return use, for_use(use)
