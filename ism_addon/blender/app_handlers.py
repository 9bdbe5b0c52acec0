# SPDX-License-Identifier: GPL-3.0-or-later
"""Removes handlers from Blender's lists, which other scripts change too."""

from collections.abc import Callable


def remove(handlers: list[Callable], handler: Callable) -> None:
    """Remove our handler, if it is still in the list."""
    if handler in handlers:
        handlers.remove(handler)
