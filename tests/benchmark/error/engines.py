# SPDX-License-Identifier: GPL-3.0-or-later
"""What takes part: an engine opens a stage, then gives pictures with the seconds that each took, a round at a time."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np


@dataclass(frozen=True, eq=False)
class Render:
    """A picture on the way."""

    samples: int
    seconds: float  # from the first sample's start to this picture, start-up excluded
    picture: np.ndarray  # (H,W,3) float32 linear, bottom row first


class Missing(Exception):
    """The engine cannot run here; the message is one sentence that says why."""


class Engine(Protocol):
    """A competitor on one stage."""

    name: str

    def start(self) -> dict[str, float]:
        """Do all that is done once, and say what it took: name to seconds or megabytes. Raises Missing."""

    def shots(self, round: int) -> Iterator[Render]:
        """Pictures of more and more samples; `round` chooses the random numbers, where there are any."""

    def close(self) -> None:
        """Free what the stage holds."""
