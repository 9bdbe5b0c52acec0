# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lists of handlers, which other scripts change too."""

from collections.abc import Callable


def remove(handlers: list[Callable], ours: Callable) -> None:
    """Remove our handler, if it is still in the list."""
    if ours in handlers:
        handlers.remove(ours)
