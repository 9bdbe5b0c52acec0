# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests in Blender share: an empty scene, things to put into it, and a look at what a render is given."""

from collections.abc import Callable, Iterator
from typing import Any

import bpy
import pytest

from ism_addon import addon
from ism_addon.blender.sync import scene_reader
from tests.tools.new_file import open_empty_file

SQUARE = ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)])


@pytest.fixture
def registered() -> Iterator[None]:
    """The add-on, for as long as the test lasts."""
    addon.register()
    yield
    addon.unregister()


@pytest.fixture
def empty_scene() -> bpy.types.Scene:
    """Factory settings and nothing in the scene."""
    return open_empty_file()


@pytest.fixture
def add(empty_scene) -> Callable[..., bpy.types.Object]:
    """add(name, data, collection=the scene's): a new object. Data may be vertices and faces, for a new mesh."""

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
def extracted(empty_scene) -> Callable[[], Any]:
    """Our Scene, of what a viewport is given."""
    return lambda: scene_reader.scene(bpy.context.evaluated_depsgraph_get())


@pytest.fixture(scope="session")
def witness() -> Iterator[type]:
    """A render engine that only calls `WitnessEngine.look(engine, depsgraph)`, and keeps what it gives or raises."""

    class WitnessEngine(bpy.types.RenderEngine):
        bl_idname = "WITNESS"
        bl_label = "Witness"
        look: Callable[[bpy.types.RenderEngine, bpy.types.Depsgraph], Any]
        seen: list[Any]

        def render(self, depsgraph: bpy.types.Depsgraph) -> None:
            try:
                self.seen.append(type(self).look(self, depsgraph))
            except Exception as error:
                self.seen.append(error)

    bpy.utils.register_class(WitnessEngine)
    yield WitnessEngine
    bpy.utils.unregister_class(WitnessEngine)


@pytest.fixture
def as_rendered(empty_scene, witness) -> Callable[..., list[Any]]:
    """as_rendered(look): what look(engine, depsgraph) gave in each call of a real render of 32 × 16 pixels."""

    def as_rendered(look: Callable[..., Any]) -> list[Any]:
        witness.look, witness.seen = staticmethod(look), []
        empty_scene.render.engine = "WITNESS"
        bpy.ops.render.render()
        for seen in witness.seen:
            if isinstance(seen, Exception):
                raise seen
        return witness.seen

    empty_scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    empty_scene.collection.objects.link(empty_scene.camera)
    empty_scene.render.resolution_x, empty_scene.render.resolution_y = 32, 16
    return as_rendered
