# SPDX-License-Identifier: GPL-3.0-or-later
"""What the frames of an animation share: what was read of the scene, and what the worker keeps for who asks.

Kept as long as Blender's render job lasts and, with its Persistent Data, until the next one.
"""

from collections.abc import Callable
from typing import Any

import bpy
from bpy.app.handlers import persistent

from ...gpu.jobs.render_thread import shared
from ...scene import Scene
from .. import app_handlers


class LayerCache:
    """A view layer that is rendered."""

    def __init__(self) -> None:
        from ..sync.scene_reader import Reader  # Blender starts without what reads scenes

        self.reader, self.client = Reader(), object()

    def read(self, depsgraph: bpy.types.Depsgraph, shown: Callable[[bpy.types.Object], bool]) -> Scene:
        """The Scene by now; what is as in the frame before is the same object. `shown` says what is wanted."""
        # Blender builds a depsgraph anew for each frame, but for Persistent Data. A new one names its scene as updated,
        # and does not say what is as it was before.
        if any(isinstance(update.id, bpy.types.Scene) for update in depsgraph.updates):
            self.reader.invalidate()
        return self.reader.read(depsgraph, shown, whole=True)


_layers: dict[tuple[int, str], LayerCache] = {}


def layer_cache(depsgraph: bpy.types.Depsgraph) -> LayerCache:
    """The depsgraph's. One is kept at a time: of many layers, the graphics card might not hold all."""
    key = depsgraph.scene.original.session_uid, depsgraph.view_layer.name
    if key not in _layers:
        forget()
    return _layers.setdefault(key, LayerCache())


def forget() -> None:
    """Let go of all that is kept."""
    while _layers:
        shared.forget(_layers.popitem()[1].client)


@persistent
def end(scene: bpy.types.Scene, *_more: Any) -> None:
    """A render job has ended."""
    if not scene.render.use_persistent_data:
        forget()


WHEN_DONE = bpy.app.handlers.render_complete, bpy.app.handlers.render_cancel


def register() -> None:
    for called in WHEN_DONE:
        called.append(end)


def unregister() -> None:
    for called in WHEN_DONE:
        app_handlers.remove(called, end)
    forget()
