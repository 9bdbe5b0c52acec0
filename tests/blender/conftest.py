# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures for tests in Blender: an empty scene, objects to add to it, and a render engine that calls a function."""

from collections.abc import Callable, Iterator
from typing import Any

import bpy
import pytest
from bpy.app.handlers import depsgraph_update_post, frame_change_post

from ism_addon import addon
from ism_addon.blender.sync import scene_reader
from ism_addon.scene import Scene
from tests.tools.new_file import open_empty_file

SQUARE = ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)])


@pytest.fixture
def registered() -> Iterator[None]:
    """The add-on is registered during the test."""
    addon.register()
    yield
    addon.unregister()


@pytest.fixture
def empty_scene() -> bpy.types.Scene:
    """The scene of Blender's factory startup file, without objects."""
    return open_empty_file()


@pytest.fixture
def add(empty_scene) -> Callable[..., bpy.types.Object]:
    """add(name, data, collection=the scene's) makes an object. Data may be vertices and faces, for a new mesh."""

    def add(name: str, data: Any = SQUARE, collection: Any = empty_scene.collection) -> bpy.types.Object:
        if isinstance(data, tuple):
            vertices, faces = data
            data = bpy.data.meshes.new(name)
            data.from_pydata(vertices, [], faces)
        thing = bpy.data.objects.new(name, data)
        collection.objects.link(thing)
        return thing

    return add


@pytest.fixture
def read_scene(empty_scene) -> Callable[[], Any]:
    """read_scene(): our Scene, read from the depsgraph of viewports."""
    return lambda: scene_reader.scene(bpy.context.evaluated_depsgraph_get())


@pytest.fixture
def latest_scene(empty_scene) -> Iterator[Callable[[], Scene]]:
    """latest_scene(): the Scene of a Reader that receives every update, and nothing else."""
    reader, read = scene_reader.Reader(), []

    def update(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
        read[:] = [reader.read(depsgraph)]

    handlers = depsgraph_update_post, frame_change_post
    for handler in handlers:
        handler.append(update)
    bpy.context.view_layer.update()
    read[:] = [reader.read(bpy.context.evaluated_depsgraph_get())]

    def latest() -> Scene:
        bpy.context.view_layer.update()
        return read[0]

    yield latest
    for handler in handlers:
        handler.remove(update)


@pytest.fixture(scope="session")
def callback_engine() -> Iterator[type]:
    """A render engine that only calls `callback(engine, depsgraph)`, and keeps what it returns or raises."""

    class CallbackEngine(bpy.types.RenderEngine):
        bl_idname = "CALLBACK"
        bl_label = "Callback"
        callback: Callable[[bpy.types.RenderEngine, bpy.types.Depsgraph], Any]
        results: list[Any]

        def render(self, depsgraph: bpy.types.Depsgraph) -> None:
            try:
                self.results.append(type(self).callback(self, depsgraph))
            except Exception as error:
                self.results.append(error)

    bpy.utils.register_class(CallbackEngine)
    yield CallbackEngine
    bpy.utils.unregister_class(CallbackEngine)


@pytest.fixture
def call_in_render(empty_scene, callback_engine) -> Callable[..., list[Any]]:
    """call_in_render(callback): the results of callback(engine, depsgraph) in a render of 32 × 16 pixels."""

    def call_in_render(callback: Callable[..., Any]) -> list[Any]:
        callback_engine.callback, callback_engine.results = staticmethod(callback), []
        empty_scene.render.engine = "CALLBACK"
        bpy.ops.render.render()
        for result in callback_engine.results:
            if isinstance(result, Exception):
                raise result
        return callback_engine.results

    empty_scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    empty_scene.collection.objects.link(empty_scene.camera)
    empty_scene.render.resolution_x, empty_scene.render.resolution_y = 32, 16
    return call_in_render
