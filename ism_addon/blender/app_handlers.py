# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lists of functions to call, which scripts of others fill and empty too."""

from collections.abc import Callable


def remove(handlers: list[Callable], ours: Callable) -> None:
    """Take ours out, if nobody has emptied the list before."""
    if ours in handlers:
        handlers.remove(ours)
