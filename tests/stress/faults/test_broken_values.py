# SPDX-License-Identifier: GPL-3.0-or-later
"""Values that are not finite, or huge: the object is left out, or the value is replaced."""

import math

import bpy
import numpy as np
import pytest

from ism_addon import addon
from ism_addon.blender.render import read_settings
from ism_addon.setting_limits import within_limits
from tests.scenes.small import box_over_plane
from tests.stress.pictures.comparisons import relative_difference
from tests.stress.pictures.into_blender import into_blender, out_of_blender
from tests.support.small_scenes import SMALL_SETTINGS, draw
from tests.tools.new_file import open_empty_file

VALUES = [math.nan, math.inf, -math.inf, 3e38]


def add_box_out_of_view() -> bpy.types.Object:
    """Add a second box where it does not change the picture. It gets the broken value."""
    bpy.ops.mesh.primitive_cube_add(location=(0.0, 0.0, -20.0))
    return bpy.context.object


def add_light_facing_away() -> bpy.types.Object:
    """Add a second light that does not change the picture. It gets the broken value."""
    bpy.ops.object.light_add(type="AREA", location=(0.0, 0.0, -20.0), rotation=(math.pi, 0.0, 0.0))
    return bpy.context.object


def vertex(value: float) -> None:
    add_box_out_of_view().data.vertices[0].co = (value, 0.0, -20.0)


def every_vertex(value: float) -> None:
    for each in add_box_out_of_view().data.vertices:
        each.co = (value, value, value)


def texture_coordinate(value: float) -> None:
    add_box_out_of_view().data.uv_layers[0].uv[0].vector = (value, value)


def location(value: float) -> None:
    add_box_out_of_view().location.x = value


def scale(value: float) -> None:
    add_box_out_of_view().scale.y = value


def rotation(value: float) -> None:
    add_box_out_of_view().rotation_euler.z = value


def lights_location(value: float) -> None:
    add_light_facing_away().location.x = value


def lights_energy(value: float) -> None:
    add_light_facing_away().data.energy = value


def lights_size(value: float) -> None:
    add_light_facing_away().data.size = value


def lights_colour(value: float) -> None:
    add_light_facing_away().data.color = (value, 1.0, 1.0)


def colour(value: float) -> None:
    box = add_box_out_of_view()
    box.data.materials.append(bpy.data.materials.new("Bad"))
    box.active_material.use_nodes = False
    box.active_material.diffuse_color = (value, 0.5, 0.5, 1.0)


#: Functions that set a broken value; their names are the tests' ids.
SETTERS = (
    *(vertex, every_vertex, texture_coordinate, location, scale, rotation, colour),
    *(lights_location, lights_energy, lights_size, lights_colour),
)


def draw_open_file(device) -> np.ndarray:
    return draw(device, *out_of_blender(), SMALL_SETTINGS).color


@pytest.mark.parametrize("value", VALUES)
@pytest.mark.parametrize("set_value", SETTERS, ids=[setter.__name__ for setter in SETTERS])
def test_a_broken_value(device, assert_within, set_value, value):
    into_blender(*box_over_plane(48, 32))
    expected = draw_open_file(device)
    set_value(value)
    assert_within(relative_difference(draw_open_file(device), expected), 1e-5)


@pytest.mark.parametrize("value", VALUES)
@pytest.mark.parametrize("path", ["ssao.radius", "ssao.intensity", "shadow.bias", "render.error_threshold"])
def test_a_broken_setting(value, path):
    """Blender's limits or ours replace it by a finite value."""
    addon.register()
    try:
        open_empty_file()
        section, name = path.split(".")
        setattr(getattr(bpy.context.scene.ism, section), name, value)
        settings = within_limits(read_settings.read(bpy.context.scene, "render"))
    finally:
        addon.unregister()
    limited = getattr(getattr(settings, {"render": "quality"}.get(section, section)), name)
    assert math.isfinite(limited)


def add_textured_sphere() -> bpy.types.Object:
    """Add a sphere with an image texture in view."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8, radius=0.6, location=(0.0, 0.0, 1.0))
    material, image = bpy.data.materials.new("Painted"), bpy.data.images.new("Image", 4, 4)
    image.pixels.foreach_set(np.linspace(0.1, 0.9, 64, dtype=np.float32))
    material.use_nodes = True
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    surface = material.node_tree.nodes["Principled BSDF"]
    material.node_tree.links.new(texture.outputs["Color"], surface.inputs["Base Color"])
    bpy.context.object.data.materials.append(material)
    return bpy.context.object


@pytest.mark.parametrize("value", [*VALUES, 1e30, -1e10])
@pytest.mark.parametrize("what", ["texture coordinates", "normals", "pixels"])
def test_broken_values_in_view(device, assert_within, what, value):
    """A visible object with broken values: the picture stays finite, and only the object's own pixels change."""
    into_blender(*box_over_plane(48, 32))
    sphere = add_textured_sphere()
    before = draw_open_file(device)
    mesh = sphere.data
    if what == "texture coordinates":
        mesh.uv_layers[0].uv.foreach_set("vector", np.full(2 * len(mesh.loops), value, np.float32))
    elif what == "normals":
        mesh.normals_split_custom_set(np.full((len(mesh.loops), 3), np.clip(value, -3e38, 3e38), np.float32))
    else:
        image = bpy.data.images.new("Broken", 4, 4, float_buffer=True)
        image.pixels.foreach_set(np.full(64, value, np.float32))
        next(node for node in sphere.active_material.node_tree.nodes if node.type == "TEX_IMAGE").image = image
    mesh.update()
    broken = draw_open_file(device)
    assert np.isfinite(broken).all()
    assert broken.min() >= 0.0
    changed = np.abs(broken - before)[..., :3].max(-1) > 1e-5
    assert_within(float(changed.mean()), 0.15)  # fraction of the picture
