# SPDX-License-Identifier: GPL-3.0-or-later
"""What registers with Blender, and in which order."""

import atexit

from .blender import engine
from .ui import borrowed, panels, properties

#: In this order; the engine last, when all that it reads is there.
PARTS = (properties, panels, borrowed, engine)


def register() -> None:
    for part in PARTS:
        part.register()
    # A render engine that is still registered when Python ends crashes or hangs Blender.
    atexit.register(unregister)


def unregister() -> None:
    atexit.unregister(unregister)
    for part in reversed(PARTS):
        part.unregister()
