# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene, view and settings to one .npz file and back: all that a picture is made of, so a bug report is a file."""

from pathlib import Path

from .scene import Scene, View
from .settings import Settings


class SnapshotError(ValueError):
    """The file is no snapshot that this version can read: the message is one sentence."""


def save(path: str | Path, scene: Scene, view: View, settings: Settings) -> None:
    """Write a snapshot. Arrays come back from `load` bit for bit."""
    raise NotImplementedError


def load(path: str | Path) -> tuple[Scene, View, Settings]:
    """Read a snapshot and check all of it. Raises SnapshotError, or OSError if the file cannot be opened."""
    raise NotImplementedError
