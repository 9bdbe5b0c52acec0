# SPDX-License-Identifier: GPL-3.0-or-later
"""What registers with Blender, and in which order."""

import atexit
from types import ModuleType

import bpy

from .blender import engine, old_files, operators
from .ui import compatible_panels, developer, panels, presets, properties, shading, statistics

#: In this order; the engine last, when all that it reads is there.
PARTS = (properties, old_files, presets, operators, panels, developer, statistics, shading, compatible_panels, engine)

_registered: list[ModuleType] = []


def register() -> None:
    """If that fails, nothing is left registered, and it can be tried again. Nothing is new where we still are."""
    if _registered:
        return
    try:
        for part in PARTS:
            part.register()
            _registered.append(part)
    except BaseException:
        _unregister_classes(part)
        unregister()
        raise
    atexit.register(_at_exit)


def _unregister_classes(part: ModuleType) -> None:
    """Those of a part that has not come to its end."""
    for each in reversed(list(vars(part).values())):
        if getattr(each, "is_registered", False) and each.__module__ == part.__name__:
            bpy.utils.unregister_class(each)


def unregister() -> None:
    """Undo register. Blender may ask for it once more at its end: then nothing is left to do.

    Raises RuntimeError while a render is under way: then all stays as it is.
    """
    if engine.is_rendering():
        raise RuntimeError("ISM is rendering: it can be disabled when the render has ended")
    atexit.unregister(_at_exit)
    while _registered:
        _registered.pop().unregister()


def _at_exit() -> None:
    """Python ends and nobody has unregistered.

    The bpy module would crash or hang with a render engine that is still registered. Blender itself would crash if
    it were unregistered now, because its types are gone: there, only the worker is left to be stopped.
    """
    if engine.IS_BPY_MODULE:
        unregister()
    else:
        engine.stop()
