# SPDX-License-Identifier: GPL-3.0-or-later
"""What pictures took, the newest of each use: "render" or "viewport"."""

from copy import deepcopy

_kept: dict[str, dict] = {}


def store(use: str, statistics: dict) -> None:
    """The newest picture of a use took this. A job that has drawn nothing yet has nothing to tell."""
    if statistics:
        _kept.pop(use, None)
        _kept[use] = statistics


def for_use(use: str) -> dict:
    """A copy of what the newest picture of a use took; {} before the first."""
    return deepcopy(_kept.get(use, {}))


def latest() -> tuple[str, dict]:
    """The use and a copy of what the newest picture of all took; "" and {} before the first."""
    use = next(reversed(_kept), "")
    return use, for_use(use)
