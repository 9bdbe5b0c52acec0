# SPDX-License-Identifier: GPL-3.0-or-later
"""State that the frames of an animation share: the scene reader, and the renderer of the render thread.

Kept until Blender's render job ends, and with Persistent Data until the next one.
"""

from collections.abc import Callable
from typing import Any

import bpy
from bpy.app.handlers import persistent

from ...gpu.jobs.render_thread import shared
from ...scene import Scene
from .. import app_handlers


class LayerCache:
    """The state of one view layer."""

    def __init__(self, frees_images: bool = False) -> None:
        from ..sync.scene_reader import Reader  # imported late: Blender starts faster

        self.reader, self.client = Reader(frees_images), object()

    def read(self, depsgraph: bpy.types.Depsgraph, is_shown: Callable[[bpy.types.Object], bool]) -> Scene:
        """The current Scene. What has not changed since the frame before is the same object."""
        # Without Persistent Data, Blender builds a new depsgraph for each frame. A new one lists its scene among the
        # updates, but not what has changed.
        if any(isinstance(update.id, bpy.types.Scene) for update in depsgraph.updates):
            self.reader.invalidate()
        return self.reader.read(depsgraph, is_shown, all_instances=True)


_layers: dict[tuple[int, str], LayerCache] = {}


def layer_cache(depsgraph: bpy.types.Depsgraph) -> LayerCache:
    """The cache of the depsgraph's view layer. Only one is kept: the graphics memory may not hold more."""
    key = depsgraph.scene.original.session_uid, depsgraph.view_layer.name
    if key not in _layers:
        forget()
    return _layers.setdefault(key, LayerCache(frees_images=True))


def forget() -> None:
    """Free all caches."""
    while _layers:
        shared.forget(_layers.popitem()[1].client)


@persistent
def end(scene: bpy.types.Scene, *_more: Any) -> None:
    """A render job has ended."""
    if not scene.render.use_persistent_data:
        forget()


RENDER_ENDED = bpy.app.handlers.render_complete, bpy.app.handlers.render_cancel


def register() -> None:
    for handlers in RENDER_ENDED:
        handlers.append(end)


def unregister() -> None:
    for handlers in RENDER_ENDED:
        app_handlers.remove(handlers, end)
    forget()
