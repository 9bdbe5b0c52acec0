# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of version 0.1.0 keep the values of settings that have been renamed since."""

from collections.abc import Iterator

import bpy
import pytest

from ism_addon import addon, old_names
from ism_addon.blender.render import read_settings
from ism_addon.settings import DebugView, Method
from tests.tools.new_file import open_empty_file


class OldShadow(bpy.types.PropertyGroup):
    method: bpy.props.EnumProperty(items=[(name, name, "") for name in ("FITTED", "CLASSIC")])


class OldQuality(bpy.types.PropertyGroup):
    samples: bpy.props.IntProperty(default=16)
    light_points: bpy.props.IntProperty(default=105)
    surface_points: bpy.props.IntProperty(default=32768)


class OldSettings(bpy.types.PropertyGroup):
    shadow: bpy.props.PointerProperty(type=OldShadow)
    render: bpy.props.PointerProperty(type=OldQuality)
    viewport: bpy.props.PointerProperty(type=OldQuality)
    show: bpy.props.EnumProperty(items=[(view, view, "") for view in old_names.DEBUG_VIEWS])


OLD = OldShadow, OldQuality, OldSettings


@pytest.fixture
def old_file(tmp_path) -> Iterator[str]:
    """A .blend that is saved while `scene.ism` has the properties of 0.1.0; then today's add-on is registered."""
    for cls in OLD:
        bpy.utils.register_class(cls)
    bpy.types.Scene.ism = bpy.props.PointerProperty(type=OldSettings)
    open_empty_file()
    ism = bpy.context.scene.ism
    ism.shadow.method, ism.show = "CLASSIC", "smooth_occlusion"
    ism.render.samples, ism.render.light_points, ism.viewport.surface_points = 3, 7, 999
    for frame, value in ((1, 500), (11, 700)):
        ism.render.surface_points = value
        bpy.context.scene.keyframe_insert("ism.render.surface_points", frame=frame)
    ism.viewport.driver_add("light_points").driver.expression = "11"
    path = str(tmp_path / "old.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    del bpy.types.Scene.ism
    for cls in reversed(OLD):
        bpy.utils.unregister_class(cls)
    addon.register()
    yield path
    addon.unregister()


def test_values_keyframes_and_drivers_get_their_new_names(old_file):
    bpy.ops.wm.open_mainfile(filepath=old_file)
    scene = bpy.context.scene
    final, viewport = read_settings.read(scene, "render"), read_settings.read(scene, "viewport")
    assert (final.shadow.method, viewport.debug_view) == (Method.SHADOW_MAPS, DebugView.AMBIENT_OCCLUSION)
    assert (final.quality.samples, final.quality.virtual_lights) == (3, 7)
    assert (viewport.quality.map_points, viewport.quality.samples) == (999, 16)
    scene.frame_set(11)
    assert scene.ism.render.map_points == 700
    scene.frame_set(1)
    assert scene.ism.render.map_points == 500
    assert scene.ism.viewport.virtual_lights == 11


def test_later_changes_are_kept_when_the_file_is_saved_and_loaded_again(old_file):
    bpy.ops.wm.open_mainfile(filepath=old_file)
    bpy.context.scene.ism.render.virtual_lights = 21
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=old_file)
    assert bpy.context.scene.ism.render.virtual_lights == 21
