# SPDX-License-Identifier: GPL-3.0-or-later
"""A thing in a file has a value that is no number: it is left out or mended, and the rest is drawn as without it."""

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


def bad_thing() -> bpy.types.Object:
    """A second box, beyond the view, where it changes nothing; and whatever is wrong is wrong with it."""
    bpy.ops.mesh.primitive_cube_add(location=(0.0, 0.0, -20.0))
    return bpy.context.object


def bad_light() -> bpy.types.Object:
    """A second light, that faces away."""
    bpy.ops.object.light_add(type="AREA", location=(0.0, 0.0, -20.0), rotation=(math.pi, 0.0, 0.0))
    return bpy.context.object


def vertex(value: float) -> None:
    bad_thing().data.vertices[0].co = (value, 0.0, -20.0)


def every_vertex(value: float) -> None:
    for each in bad_thing().data.vertices:
        each.co = (value, value, value)


def texture_coordinate(value: float) -> None:
    bad_thing().data.uv_layers[0].uv[0].vector = (value, value)


def location(value: float) -> None:
    bad_thing().location.x = value


def scale(value: float) -> None:
    bad_thing().scale.y = value


def rotation(value: float) -> None:
    bad_thing().rotation_euler.z = value


def lights_location(value: float) -> None:
    bad_light().location.x = value


def lights_energy(value: float) -> None:
    bad_light().data.energy = value


def lights_size(value: float) -> None:
    bad_light().data.size = value


def lights_colour(value: float) -> None:
    bad_light().data.color = (value, 1.0, 1.0)


def colour(value: float) -> None:
    thing = bad_thing()
    thing.data.materials.append(bpy.data.materials.new("Bad"))
    thing.active_material.use_nodes = False
    thing.active_material.diffuse_color = (value, 0.5, 0.5, 1.0)


BREAKS = (
    *(vertex, every_vertex, texture_coordinate, location, scale, rotation, colour),
    *(lights_location, lights_energy, lights_size, lights_colour),
)


def drawn(device) -> np.ndarray:
    return draw(device, *out_of_blender(), SMALL_SETTINGS).color


@pytest.mark.parametrize("value", VALUES)
@pytest.mark.parametrize("broken", BREAKS, ids=[broken.__name__ for broken in BREAKS])
def test_a_broken_value(device, within, broken, value):
    into_blender(*box_over_plane(48, 32))
    whole = drawn(device)
    broken(value)
    within(relative_difference(drawn(device), whole), 1e-5)


@pytest.mark.parametrize("value", VALUES)
@pytest.mark.parametrize("path", ["ssao.radius", "ssao.intensity", "shadow.bias", "render.error_threshold"])
def test_a_broken_setting(value, path):
    """Blender's own limits, or ours, make a number of it."""
    addon.register()
    try:
        open_empty_file()
        section, name = path.split(".")
        setattr(getattr(bpy.context.scene.ism, section), name, value)
        told = within_limits(read_settings.read(bpy.context.scene, "render"))
    finally:
        addon.unregister()
    held = getattr(getattr(told, {"render": "quality"}.get(section, section)), name)
    assert math.isfinite(held)


def painted() -> bpy.types.Object:
    """A thing in view, painted with an image."""
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
def test_broken_values_in_view(device, within, what, value):
    """A thing that is seen: its own pixels are light or dark, and no more pixels than it has are not as before."""
    into_blender(*box_over_plane(48, 32))
    thing = painted()
    whole = drawn(device)
    mesh = thing.data
    if what == "texture coordinates":
        mesh.uv_layers[0].uv.foreach_set("vector", np.full(2 * len(mesh.loops), value, np.float32))
    elif what == "normals":
        mesh.normals_split_custom_set(np.full((len(mesh.loops), 3), np.clip(value, -3e38, 3e38), np.float32))
    else:
        image = bpy.data.images.new("Broken", 4, 4, float_buffer=True)
        image.pixels.foreach_set(np.full(64, value, np.float32))
        next(node for node in thing.active_material.node_tree.nodes if node.type == "TEX_IMAGE").image = image
    mesh.update()
    broken = drawn(device)
    assert np.isfinite(broken).all()
    assert broken.min() >= 0.0
    near = np.abs(broken - whole)[..., :3].max(-1) > 1e-5
    within(float(near.mean()), 0.15)  # of the picture
