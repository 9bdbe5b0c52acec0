# SPDX-License-Identifier: GPL-3.0-or-later
"""Axes and radiance of area lights, and the world's radiance, compared with Cycles."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from ism_addon import addon
from ism_addon.scene import LightShape

SHAPES = ["SQUARE", "RECTANGLE", "DISK", "ELLIPSE"]


def area_light(shape="SQUARE", **properties):
    """An area light of 2 m by 3 m and 40 W."""
    light = bpy.data.lights.new("Lamp", "AREA")
    light.shape, light.size, light.size_y, light.energy = shape, 2.0, 3.0, 40.0
    for name, value in properties.items():
        setattr(light, name, value)
    return light


@pytest.mark.parametrize("shape", SHAPES)
def test_axes_are_the_full_size_under_the_objects_scale(add, read_scene, shape):
    thing = add("Lamp", area_light(shape))
    thing.scale, thing.location, thing.rotation_euler = (2, 0.5, 3), (1, 2, 3), (math.pi / 2, 0, 0)
    lights = read_scene().lights
    height = 3.0 if shape in ("RECTANGLE", "ELLIPSE") else 2.0
    round_shape = shape in ("DISK", "ELLIPSE")
    area = 4.0 * 0.5 * height * (math.pi / 4 if round_shape else 1.0)
    assert lights.shape.tolist() == [LightShape.ELLIPSE if round_shape else LightShape.RECTANGLE]
    assert lights.position.tolist() == [[1, 2, 3]]
    assert np.allclose(lights.axis_u, (4, 0, 0), atol=1e-6)
    assert np.allclose(lights.axis_v, (0, 0, 0.5 * height), atol=1e-6)
    assert np.allclose(lights.normal, (0, 1, 0), atol=1e-6)
    assert np.allclose(lights.emission, 40 / (math.pi * area))
    assert lights.spread.tolist() == [np.float32(math.pi)]
    assert lights.casts_shadow.tolist() == [True]


def cycles_radiance(scene, tmp_path):
    """(3,) the colour of a light at the origin, as Cycles renders it for a camera below the light."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.01, 0.01, -1.0), (math.pi, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    render, cycles = scene.render, scene.cycles
    render.engine, render.resolution_x, render.resolution_y = "CYCLES", 4, 4
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = 1, False, False
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = str(tmp_path / "cycles.exr")
    bpy.ops.render.render(write_still=True)
    picture = bpy.data.images.load(render.filepath)
    pixels = np.array(picture.pixels).reshape(4, 4, 4)
    return pixels[2, 2, :3]


@pytest.mark.parametrize("normalize", [True, False])
@pytest.mark.parametrize("shape", SHAPES)
def test_radiance_equals_that_of_cycles(add, read_scene, empty_scene, tmp_path, shape, normalize):
    light = area_light(shape, color=(1, 0.5, 0.25))
    if hasattr(light, "normalize"):
        light.normalize, light.exposure, light.use_temperature, light.temperature = normalize, 1.0, True, 4000.0
    thing = add("Lamp", light)
    thing.scale, thing.visible_camera = (1.5, 2, 1), True
    ours = read_scene().lights.emission[0]
    assert np.allclose(ours, cycles_radiance(empty_scene, tmp_path), rtol=1e-4)


def test_a_sheared_light_keeps_its_axes(add, read_scene):
    parent = add("Parent", None)
    parent.scale = (1, 3, 1)
    thing = add("Lamp", area_light("RECTANGLE"))
    thing.parent, thing.rotation_euler = parent, (0, 0, 0.6)
    lights = read_scene().lights
    matrix = np.array(thing.matrix_world)
    assert np.allclose(lights.axis_u[0], 2 * matrix[:3, 0])
    assert np.allclose(lights.axis_v[0], 3 * matrix[:3, 1])
    assert abs(lights.axis_u[0] @ lights.axis_v[0]) > 1


def test_spread_and_shadow_are_read(add, read_scene):
    add("Lamp", area_light(spread=1.25, use_shadow=False))
    lights = read_scene().lights
    assert lights.spread.tolist() == [1.25]
    assert lights.casts_shadow.tolist() == [False]


@pytest.fixture
def registered():
    addon.register()
    yield
    addon.unregister()


def test_a_coloured_shadow_is_that_of_a_second_light_without_one(registered, add, read_scene):
    light = area_light(energy=40.0)
    light.ism.shadow_color, light.ism.shadow_density, light.ism.shadow_softness = (0.0, 0.5, 1.0), 0.8, 2.5
    add("Lamp", light)
    lights = read_scene().lights
    assert lights.casts_shadow.tolist() == [True, False]
    assert lights.shadow_softness.tolist() == [2.5, 2.5]
    assert np.allclose(lights.emission[0] / lights.emission.sum(0), [0.8, 0.4, 0.0])


@pytest.mark.parametrize(("density", "casts_shadow"), [(1.0, [True]), (0.0, [False])])
def test_a_light_with_a_black_shadow_or_none_is_one_light(registered, add, read_scene, density, casts_shadow):
    light = area_light()
    light.ism.shadow_density = density
    add("Lamp", light)
    assert read_scene().lights.casts_shadow.tolist() == casts_shadow


def test_the_controls_of_a_shadow_are_animated(registered, add, read_scene):
    light = area_light()
    for frame, softness in ((1, 0.0), (11, 1.0)):
        light.ism.shadow_softness = softness
        light.ism.keyframe_insert("shadow_softness", frame=frame)
    add("Lamp", light)
    bpy.context.scene.frame_set(6)
    assert read_scene().lights.shadow_softness == pytest.approx(0.5)


def test_negative_power_gives_negative_radiance(add, read_scene):
    add("Lamp", area_light(energy=-40.0))
    assert np.all(read_scene().lights.emission < 0)


def test_a_point_light_is_read(add, read_scene):
    light = bpy.data.lights.new("Lamp", "POINT")
    light.energy, light.shadow_soft_size, light.use_soft_falloff = 40.0, 0.25, False
    thing = add("Lamp", light)
    thing.location, thing.scale = (1, 2, 3), (2, 0, 1)  # its scale changes nothing, as in Cycles
    lights = read_scene().lights
    assert lights.shape.tolist() == [LightShape.POINT]
    assert lights.position.tolist() == [[1, 2, 3]]
    assert (lights.radius.tolist(), lights.soft_falloff.tolist()) == ([0.25], [False])
    assert np.allclose(lights.emission, 40 / (4 * math.pi))


@pytest.mark.parametrize("radius", [0.0, 0.5])
def test_a_point_light_that_is_not_normalized_has_a_radiance_of_its_power(add, read_scene, radius):
    light = bpy.data.lights.new("Lamp", "POINT")
    light.energy, light.shadow_soft_size = 40.0, radius
    if not hasattr(light, "normalize"):
        return  # before Blender 4.5
    light.normalize = False
    add("Lamp", light)
    assert np.allclose(read_scene().lights.emission, 40 * (radius**2 or 1 / math.pi))


def test_a_point_light_at_no_place_is_left_out_and_reported(add, read_scene):
    add("Lamp", bpy.data.lights.new("Lamp", "POINT")).location = (math.inf, 0, 0)
    scene = read_scene()
    assert len(scene.lights.shape) == 0
    assert scene.warnings == ("Point lights of a radius or at a position beyond measure are left out: 'Lamp'.",)


@pytest.mark.parametrize("properties", [{"energy": 0.0}, {"color": (0, 0, 0)}])
def test_a_light_without_power_is_left_out_silently(add, read_scene, properties):
    add("Lamp", area_light(**properties))
    scene = read_scene()
    assert len(scene.lights.shape) == 0
    assert scene.warnings == ()


@pytest.mark.parametrize("scale", [(0, 1, 1), (1, 0, 1), (1, 1, 0), (math.nan, 1, 1), (1, math.inf, 1)])
def test_a_light_without_a_size_is_left_out_and_reported(add, read_scene, scale):
    add("Lamp", area_light()).scale = scale
    scene = read_scene()
    assert len(scene.lights.shape) == 0
    assert scene.warnings == ("Area lights without a size, or of one beyond measure, are left out: 'Lamp'.",)


def test_a_light_of_size_zero_is_left_out_and_reported(add, read_scene):
    add("Lamp", area_light("RECTANGLE", size_y=0.0))
    scene = read_scene()
    assert len(scene.lights.shape) == 0
    assert scene.warnings == ("Area lights without a size, or of one beyond measure, are left out: 'Lamp'.",)


def test_a_light_that_is_too_bright_is_left_out_and_reported(add, read_scene):
    add("Lamp", area_light(energy=3e38))
    scene = read_scene()
    assert len(scene.lights.shape) == 0
    assert scene.warnings == ("Area lights too bright to be drawn are left out: 'Lamp'.",)


@pytest.mark.parametrize("angle", [0.0, 0.25])
def test_a_sun_is_read(add, read_scene, angle):
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy, light.angle = 3.0, angle
    sun = add("Sun", light)
    sun.location, sun.scale, sun.rotation_euler = (1e30, 2, 3), (2, 0, 7), (0, math.pi / 2, 0)  # the last one matters
    lights = read_scene().lights
    assert lights.shape.tolist() == [LightShape.SUN]
    assert np.allclose(lights.normal, [[-1, 0, 0]], atol=1e-6)
    assert lights.spread == pytest.approx(angle)
    assert np.allclose(lights.emission, 3.0)


@pytest.mark.parametrize(("angle", "expected"), [(0.0, 3.0), (math.pi, 3.0 * math.pi)])
def test_a_sun_that_is_not_normalized_has_a_radiance_of_its_strength(add, read_scene, angle, expected):
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy, light.angle = 3.0, angle
    if not hasattr(light, "normalize"):
        return  # before Blender 4.5
    light.normalize = False
    add("Sun", light)
    assert np.allclose(read_scene().lights.emission, expected)


def test_a_sun_without_a_direction_is_left_out_and_reported(add, read_scene):
    add("Sun", bpy.data.lights.new("Sun", "SUN")).scale = (0, 0, 0)
    scene = read_scene()
    assert len(scene.lights.shape) == 0
    assert scene.warnings == ("Suns without a direction, or of an angle beyond measure, are left out: 'Sun'.",)


def test_no_lights_are_an_empty_table(add, read_scene):
    lights = read_scene().lights
    assert lights.position.shape == (0, 3)
    assert lights.emission.dtype == np.float32
    assert lights.normal.dtype == np.float64


def test_a_mirrored_light_has_the_opposite_normal(add, read_scene):
    thing = add("Lamp", area_light())
    thing.matrix_world = Matrix.Diagonal((1, 1, -1, 1))
    assert np.allclose(read_scene().lights.normal, np.array(thing.matrix_world)[:3, 2] * -1)


def world_with_nodes(scene):
    world = scene.world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0):
        world.use_nodes = True
    return world


def test_the_world_is_its_background_times_its_strength(read_scene, empty_scene):
    background = world_with_nodes(empty_scene).node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0.5, 0.25, 1, 1)
    background.inputs["Strength"].default_value = 2
    assert read_scene().world.radiance.tolist() == [1, 0.5, 2]


def test_no_world_is_black(read_scene):
    assert read_scene().world.radiance.tolist() == [0, 0, 0]


@pytest.mark.skipif(bpy.app.version >= (5, 0), reason="since Blender 5.0 a world always has nodes")
def test_a_world_without_nodes_has_its_own_colour(read_scene, empty_scene):
    empty_scene.world = bpy.data.worlds.new("World")
    empty_scene.world.color = (0.5, 0.25, 0.125)
    assert read_scene().world.radiance.tolist() == [0.5, 0.25, 0.125]


def test_a_world_of_an_unknown_node_has_the_plain_colour_and_is_reported(read_scene, empty_scene):
    tree = world_with_nodes(empty_scene).node_tree
    background = tree.nodes["Background"]
    background.inputs["Color"].default_value = (0.25, 0.25, 0.25, 1)
    background.inputs["Strength"].default_value = 1
    tree.links.new(tree.nodes.new("ShaderNodeAmbientOcclusion").outputs["Color"], background.inputs["Color"])
    scene = read_scene()
    assert scene.world.radiance.tolist() == [0.25, 0.25, 0.25]
    assert scene.warnings == (
        "Worlds whose Color is given by a node 'Ambient Occlusion' have the socket's own value: 'World'.",
    )


def test_a_world_that_is_not_finite_has_finite_radiance(read_scene, empty_scene):
    background = world_with_nodes(empty_scene).node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (math.nan, 1, 1, 1)
    background.inputs["Strength"].default_value = math.inf
    assert np.isfinite(read_scene().world.radiance).all()
