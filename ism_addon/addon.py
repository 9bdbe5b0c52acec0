# SPDX-License-Identifier: GPL-3.0-or-later
"""Registers the add-on with Blender."""

import atexit
from types import ModuleType

import bpy

from .blender import engine, old_files, operators
from .ui import compatible_panels, developer, panels, presets, properties, shading, statistics

#: Modules in the order of registration. The engine is last, because it uses the others.
MODULES = (properties, old_files, presets, operators, panels, developer, statistics, shading, compatible_panels, engine)

_registered: list[ModuleType] = []


def register() -> None:
    """Register all modules, unless they are registered. If one fails, all are unregistered again."""
    if _registered:
        return
    try:
        for module in MODULES:
            module.register()
            _registered.append(module)
    except BaseException:
        _unregister_classes(module)
        unregister()
        raise
    atexit.register(_at_exit)


def _unregister_classes(module: ModuleType) -> None:
    """Unregister the classes of a module whose register() has failed."""
    for each in reversed(list(vars(module).values())):
        if getattr(each, "is_registered", False) and each.__module__ == module.__name__:
            bpy.utils.unregister_class(each)


def unregister() -> None:
    """Unregister all modules. Blender may call it again at exit, which does nothing.

    Raises RuntimeError while a render is running; then nothing is unregistered.
    """
    if engine.is_rendering():
        raise RuntimeError("ISM is rendering: it can be disabled when the render has ended")
    atexit.unregister(_at_exit)
    while _registered:
        _registered.pop().unregister()


def _at_exit() -> None:
    """Called when Python exits and the add-on is still registered.

    The bpy module would crash or hang with a registered render engine. Blender itself would crash if it were
    unregistered now, because its types are freed: there, only the render thread is stopped.
    """
    if engine.IS_BPY_MODULE:
        unregister()
    else:
        engine.stop()
