# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares unshadowed light with Cycles: scaled area lights of all shapes and spreads, points, spots, suns."""

import itertools
import math
from dataclasses import replace

import bmesh
import bpy
import numpy as np
import pytest

from ism_addon.blender.sync import camera, scene_reader
from ism_addon.gpu.renderer import Profile, Renderer
from ism_addon.settings import SSAO, Quality, Settings, Shadow
from tests.scenes.cycles import PIXEL_CENTRES, direct_light

SIDE, TILE = 64, 8
SPREADS = {"plain": math.pi, "wide": math.radians(120.0), "narrow": math.radians(40.0)}
#: Cycles' samples. Narrow round lights need most, because only a part of Cycles' samples hit them. Its noise is below
#: half of the bounds.
SAMPLES = {"plain": 64, "wide": 64, "narrow": 384}
#: Bounds of the relative error of a tile: of the median, and of the 0.9 quantile.
BOUNDS = {"plain": (0.0002, 0.0005), "wide": (0.0003, 0.001), "narrow": (0.003, 0.008)}


def also(*values: object) -> list:
    """Further values of a parameter: if a release of Blender had another formula, the unmarked values would tell."""
    as_one = (value if isinstance(value, tuple) else (value,) for value in values)
    return [pytest.param(*each, marks=pytest.mark.any_release) for each in as_one]


def area_light(shape: str, spread: float) -> bpy.types.Light:
    light = bpy.data.lights.new("lamp", "AREA")
    light.shape, light.size, light.size_y, light.spread, light.energy = shape, 1.0, 0.5, spread, 50.0
    return light


def point_light(radius: float, soft_falloff: bool) -> bpy.types.Light:
    light = bpy.data.lights.new("lamp", "POINT")
    light.shadow_soft_size, light.use_soft_falloff, light.energy = radius, soft_falloff, 50.0
    return light


@pytest.fixture
def light_over_plane(empty_scene, add):
    """light_over_plane(light): a light, tilted and scaled, above a white plane, and a camera above both."""

    def build(light: bpy.types.Light) -> bpy.types.Object:
        plane = add("plane", ([(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)], [(0, 1, 2, 3)]))
        white = bpy.data.materials.new("white")
        white.use_nodes = True
        principled = white.node_tree.nodes["Principled BSDF"]
        principled.inputs["Base Color"].default_value = (0.8, 0.6, 0.4, 1.0)
        principled.inputs["Specular IOR Level"].default_value = 0.0
        plane.data.materials.append(white)
        light_object = add("lamp", light)
        light_object.location, light_object.rotation_euler = (0.4, 0.2, 1.5), (0.3, 0.2, 0.5)
        light_object.scale = (1.4, 0.8, 1.0)
        light_object.visible_camera = False
        data = bpy.data.cameras.new("camera")
        data.lens = 30.0
        empty_scene.camera = add("camera", data)
        empty_scene.camera.location = (0.0, 0.0, 3.5)
        empty_scene.render.resolution_x = empty_scene.render.resolution_y = SIDE
        return light_object

    return build


@pytest.mark.parametrize("spread", SPREADS)
@pytest.mark.parametrize("shape", ["RECTANGLE", "ELLIPSE", *also("SQUARE", "DISK")])
def test_unshadowed_light_equals_that_of_cycles(device, light_over_plane, shape, spread):
    light_over_plane(area_light(shape, SPREADS[spread]))
    assert_equals_cycles(device, SAMPLES[spread], BOUNDS[spread])


@pytest.mark.parametrize("soft_falloff", [False, True], ids=["sphere", "soft"])
@pytest.mark.parametrize("radius", [0.0, 0.4, 1.3])
def test_point_lights_equal_those_of_cycles(device, light_over_plane, radius, soft_falloff):
    """The last one almost touches the plane."""
    light_over_plane(point_light(radius, soft_falloff))
    assert_equals_cycles(device, 64 if radius < 1.0 else 256, (0.0003, 0.002))


SPOTS = {
    "hard edge": {"spot_size": 1.0, "spot_blend": 0.0},
    "soft edge": {"spot_size": 1.0, "spot_blend": 0.15},
    "all fades": {"spot_size": 1.4, "spot_blend": 1.0},
    "wide": {"spot_size": 2.8, "spot_blend": 0.5},
}


@pytest.mark.parametrize("scale", [(1.2, 1.2, 1.2), (1.4, 0.8, 1.0)], ids=["circular", "elliptical"])
@pytest.mark.parametrize(("radius", "soft_falloff"), [(0.0, False), (0.2, False), (0.2, True)])
@pytest.mark.parametrize("spot", ["soft edge", *also("hard edge", "all fades", "wide")])
def test_spot_lights_equal_those_of_cycles(device, light_over_plane, spot, radius, soft_falloff, scale):
    """Elliptical cones with a radius are not exact, so few samples tell. Hard edges need more of Cycles' samples."""
    light = bpy.data.lights.new("lamp", "SPOT")
    light.shadow_soft_size, light.use_soft_falloff, light.energy = radius, soft_falloff, 50.0
    for name, value in SPOTS[spot].items():
        setattr(light, name, value)
    light_over_plane(light).scale = scale
    elliptical = radius > 0.0 and scale[0] != scale[1]
    samples = (256 if light.spot_blend or elliptical else 512) if radius else 16
    assert_equals_cycles(device, samples, (0.003, 0.012) if elliptical else (0.0005, 0.006))


@pytest.mark.parametrize(
    ("angle", "normalize"),
    [
        (0.0, True),
        (0.5, True),
        (2.0, True),
        (0.0, False),
        (0.5, False),
        *also((math.radians(0.526), True), (math.pi, True)),
    ],
)
def test_suns_equal_those_of_cycles(device, light_over_plane, angle, normalize):
    light = bpy.data.lights.new("lamp", "SUN")
    light.angle, light.energy = angle, 2.0
    if hasattr(light, "normalize"):
        light.normalize = normalize
        light.energy /= 1.0 if normalize else max(math.sin(angle / 2.0) ** 2, 1e-4)  # to be as bright
    light_over_plane(light).rotation_euler = (1.2, 0.2, 0.5)  # the horizon cuts the large ones
    assert_equals_cycles(device, 64 if angle < 1.0 else 1024, (0.0003, 0.002))


SEEN = {
    "square": ("AREA", {"shape": "SQUARE", "size": 0.8}),
    "ellipse with spread": ("AREA", {"shape": "ELLIPSE", "size": 1.0, "size_y": 0.5, "spread": 2.0}),
    "sphere": ("POINT", {"shadow_soft_size": 0.3}),
    "disk": ("POINT", {"shadow_soft_size": 0.3, "use_soft_falloff": True}),
    "spot": ("SPOT", {"shadow_soft_size": 0.3, "spot_size": 1.5, "spot_blend": 1.0}),
    "sun": ("SUN", {"angle": 0.5}),
}


@pytest.mark.parametrize("rotation", [(math.pi - 0.6, 0.2, 0.5), (0.6, 0.2, 0.5)], ids=["towards", "away"])
@pytest.mark.parametrize("name", SEEN)
def test_lights_that_the_camera_sees_equal_those_of_cycles(device, light_over_plane, name, rotation):
    """The camera sees through them. It looks down at them, and sees the sun beside a small plane."""
    kind, properties = SEEN[name]
    light = bpy.data.lights.new("lamp", kind)
    light.energy = 2.0 if kind == "SUN" else 50.0
    for key, value in properties.items():
        setattr(light, key, value)
    lamp = light_over_plane(light)
    lamp.visible_camera, lamp.rotation_euler = True, rotation
    bpy.data.objects["plane"].scale = (0.2, 0.2, 1.0) if kind == "SUN" else (1.0, 1.0, 1.0)
    ours = our_picture(device)
    lamp.visible_camera = False
    is_seen = np.abs(ours - our_picture(device)).max(-1) > 0.1 * ours.max()
    lamp.visible_camera = True
    theirs = direct_light(64)[..., :3]
    differs = ~np.isclose(ours, theirs, 0.03, 2e-3 * theirs.max()).all(-1)  # by noise, and by a pixel at the outline
    assert differs.mean() < 0.01
    assert is_seen.any() == (rotation[0] > 1.0 or kind == "POINT")


EMITTERS = {
    "triangle": ([(-0.6, -0.5, 0), (0.7, -0.4, 0), (0, 0.8, 0)], [(0, 1, 2)]),
    "quad": ([(-0.6, -0.5, 0), (0.6, -0.5, 0), (0.6, 0.5, 0), (-0.6, 0.5, 0)], [(0, 1, 2, 3)]),
    "box": lambda shape: bmesh.ops.create_cube(shape, size=0.7),
    "sphere of 960 triangles": lambda shape: bmesh.ops.create_uvsphere(shape, u_segments=32, v_segments=16, radius=0.5),
}


@pytest.mark.parametrize(
    ("name", "shader"),
    [
        *itertools.product(("quad", "box"), ("Emission", "Principled")),
        pytest.param("triangle", "Emission", marks=pytest.mark.any_release),
        pytest.param("sphere of 960 triangles", "Emission", marks=pytest.mark.any_release),
    ],
)
def test_emissive_meshes_equal_those_of_cycles(device, light_over_plane, add, name, shader):
    """Convex ones: without shadows ours have no inner sides. The camera sees a part of them."""
    lamp = light_over_plane(point_light(0.0, False))
    bpy.data.objects.remove(lamp)
    emitter = add("emitter", EMITTERS[name] if isinstance(EMITTERS[name], tuple) else ([], []))
    if not isinstance(EMITTERS[name], tuple):
        shape = bmesh.new()
        EMITTERS[name](shape)
        shape.to_mesh(emitter.data)
        shape.free()
    emitter.location, emitter.rotation_euler, emitter.scale = (0.4, 0.2, 1.5), (0.3, 0.2, 0.5), (1.4, 0.8, 1.0)
    emitter.data.materials.append(emissive_material(shader))
    emitter.visible_camera = False
    many = name.startswith("sphere")
    assert_equals_cycles(device, 1024 if many else 256, (0.001, 0.004), light_tree=many)
    emitter.visible_camera = True
    ours, theirs = our_picture(device), direct_light(1)[..., :3]
    assert ours.max() == pytest.approx(theirs.max(), rel=1e-6)
    assert ((ours == ours.max()) != (theirs == theirs.max())).mean() < 0.003, "but for pixels at the outline"


def emissive_material(shader: str, strength: float = 5.0) -> bpy.types.Material:
    """Black, and emits."""
    material = bpy.data.materials.new("glow")
    material.use_nodes = True
    tree, node = material.node_tree, material.node_tree.nodes["Principled BSDF"]
    names = ("Emission Color", "Emission Strength")
    if shader == "Emission":
        node = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        names = ("Color", "Strength")
    else:
        node.inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
        node.inputs["Specular IOR Level"].default_value = 0.0
    for socket, value in zip(names, ((1.0, 0.6, 0.3, 1.0), strength), strict=True):
        node.inputs[socket].default_value = value
    return material


def our_picture(device) -> np.ndarray:
    """(H,W,3) of the open scene, without shadows and ambient occlusion."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    scene = scene_reader.scene(depsgraph)
    view = replace(camera.final_view(depsgraph), filter_width=PIXEL_CENTRES)  # as the reference
    renderer = Renderer(device)
    settings = Settings(
        shadow=Shadow(enabled=False), ssao=SSAO(enabled=False), quality=Quality(samples=1, virtual_lights=4)
    )
    for _ in renderer.sample(scene, view, settings, 0, Profile()):
        pass
    picture = renderer.picture()[..., :3]
    renderer.release()
    return picture


def assert_equals_cycles(device, samples: int, bounds: tuple[float, float], light_tree: bool = False) -> None:
    """Compare tiles of the open scene: bounds of the median and of the 0.9 quantile of their relative errors."""
    ours, theirs = our_picture(device), direct_light(samples, light_tree=light_tree)[..., :3]
    tiles = np.median(
        [np.reshape(p, (SIDE // TILE, TILE, SIDE // TILE, TILE, 3)).mean((1, 3)) for p in (ours, theirs)], -1
    )
    lit = tiles[1] > 0.05 * tiles[1].max()
    error = np.abs(tiles[0] / np.where(lit, tiles[1], 1.0) - 1.0)[lit]
    assert lit.sum() >= 8
    assert np.median(error) < bounds[0] and np.quantile(error, 0.9) < bounds[1]
