# SPDX-License-Identifier: GPL-3.0-or-later
"""The interface of a measured engine: it starts on a scene, then yields renders with their times, round by round."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np


@dataclass(frozen=True, eq=False)
class Render:
    """A picture after some samples."""

    samples: int
    seconds: float  # from the first sample's start to this picture, start-up excluded
    picture: np.ndarray  # (H,W,3) float32 linear, bottom row first


class Missing(Exception):
    """The engine cannot run here. The message is one sentence that says why."""


class Engine(Protocol):
    """A renderer of one scene."""

    name: str

    def start(self) -> dict[str, float]:
        """Do what is done once. Returns what it took by name, in seconds or megabytes. Raises Missing."""

    def renders(self, round: int) -> Iterator[Render]:
        """Renders with increasing numbers of samples. `round` is the seed of engines that have one."""

    def close(self) -> None:
        """Free all resources."""
