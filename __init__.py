# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's door to the extension. Imports wait inside, so that this folder can be a package without Blender."""


def register() -> None:
    from .ism_addon import addon

    addon.register()


def unregister() -> None:
    from .ism_addon import addon

    addon.unregister()
