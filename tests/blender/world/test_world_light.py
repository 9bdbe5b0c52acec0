# SPDX-License-Identifier: GPL-3.0-or-later
"""Light of worlds that vary, beside Cycles."""

import bpy
import numpy as np
import pytest

from ism_addon.blender.engine import statistics
from tests.benchmark.files import FILTER_WIDTH, our_render
from tests.scenes.cycles import direct_light
from tests.scenes.parts.node_tree import made, world_of
from tests.scenes.worlds import interior

from .beside_cycles import TRUTH, error
from .test_background import SKIES, WORLDS, background, by_ray, clouds, sky

pytestmark = pytest.mark.usefixtures("registered")

#: Samples of ours; the largest RMSE over the mean.
SAMPLES, BOUND = 64, 0.03


def reflecting(**inputs):
    return made(lambda tree: tree.add("ShaderNodeBsdfPrincipled", inputs))


@pytest.mark.parametrize(
    "name", ["an image all around", "a mirror ball", "noise", "two shaders", "coordinates Reflection"]
)
def test_surfaces_are_lit_as_in_cycles(place, name):
    place.scene.world = world_of(WORLDS[name])
    for each in (place.floor, place.ball, place.block):
        each.data.materials.append(reflecting(**{"Specular IOR Level": 0.0}))
    assert error(our_render(SAMPLES)[0]) <= BOUND


@pytest.mark.parametrize("brightness", [1.0, 100.0])
def test_the_sun_in_an_image_casts_a_shadow_as_in_cycles(place, brightness):
    """A few texels, which give half of the light, or nearly all: more than 16-bit floats can be."""

    def with_sun(tree):
        colors = np.ones((64, 128, 4), np.float32)
        colors[44:46, 30:32, :3] = np.multiply((2e3, 1.6e3, 1.2e3), brightness)
        image = bpy.data.images.new("sun", 128, 64, float_buffer=True)
        image.pixels.foreach_set(colors.ravel())
        image.pack()
        return background(tree, tree.add("ShaderNodeTexEnvironment", image=image))

    place.scene.world = world_of(with_sun)
    assert error(our_render(16)[0]) <= BOUND
    assert statistics()["lights_used"] == 2


@pytest.mark.parametrize("model", SKIES)
def test_a_sky_and_its_sun_light_surfaces_as_in_cycles(place, model):
    place.scene.world = world_of(lambda tree: sky(tree, model, sun_size=0.1))
    assert error(our_render(SAMPLES)[0]) <= BOUND


def test_a_camera_sees_a_skys_sun(place):
    """Ours is even, and adds to the sky: Cycles' is darker at the limb, and before Blender 5.0 replaces the sky."""
    model = next(each for each in SKIES if each in ("NISHITA", "SINGLE_SCATTERING"))
    place.scene.world = world_of(lambda tree: sky(tree, model, sun_size=0.4))
    place.scene.camera.rotation_euler = 0.5 * np.pi + 0.5, 0.0, -2.2
    ours, theirs = our_render(SAMPLES)[0], direct_light(TRUTH, FILTER_WIDTH)[..., :3]
    assert ours.max() > 20.0 * np.median(ours) and ours.mean() == pytest.approx(theirs.mean(), rel=0.03)


@pytest.mark.parametrize("roughness", [0.0, 0.15, 0.4, 1.0])
def test_metal_reflects_the_world_as_in_cycles(place, roughness):
    place.scene.world = world_of(WORLDS["an image all around"])
    for each in (place.floor, place.ball, place.block):
        each.data.materials.append(reflecting(Metallic=1.0, Roughness=roughness))
    assert error(our_render(SAMPLES)[0]) <= 2.0 * BOUND  # a mirror shows each edge of the image


def test_a_map_lights_a_room_through_its_windows(tmp_path):
    """Rays to all of the map would leave 1.4 times the error."""
    interior.build(tmp_path / "interior.blend")
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y, render.filter_size = 128, 72, FILTER_WIDTH
    assert error(our_render(4)[0], 64, darker_than=1.0) <= 0.32


def test_what_the_camera_sees_does_not_light_surfaces(place):
    place.scene.world = world_of(by_ray)
    assert error(our_render(SAMPLES)[0]) <= 1.5 * BOUND  # edges before a bright background


def test_the_shade_has_the_color_of_the_part_of_the_world_that_lights_it(place, add):
    """A wall hides the red half. A visibility of the whole is right in luminance, but not in color."""

    def halves(tree):
        axes = tree.add("ShaderNodeSeparateXYZ", {0: tree.add("ShaderNodeTexCoord").outputs["Generated"]})
        is_blue = tree.add("ShaderNodeMath", {0: axes.outputs["X"], 1: 0.0}, operation="GREATER_THAN")
        colors = {"Color1": (1.0, 0.1, 0.1, 1.0), "Color2": (0.1, 0.1, 2.95, 1.0)}
        return background(tree, tree.add("ShaderNodeMixRGB", {"Fac": is_blue, **colors}))

    place.scene.world = world_of(halves)
    wall = [(-2.0, -9.0, 0.0), (-2.0, 9.0, 0.0), (-2.0, 9.0, 30.0), (-2.0, -9.0, 30.0)]
    add("Wall", (wall, [(0, 1, 2, 3)]))
    ours, theirs = our_render(16)[0], direct_light(TRUTH, FILTER_WIDTH)[..., :3]
    assert ours.mean((0, 1)) == pytest.approx(theirs.mean((0, 1)), rel=0.02)


def test_a_world_that_varies_is_evaluated_once(place):
    place.scene.world = world_of(clouds)
    our_render(2)
    assert statistics()["passes"]["BakeWorld"]["drawn"] == 1
    place.scene.world = world_of(lambda tree: background(tree, (0.2, 0.4, 0.6, 1.0)))
    our_render(2)
    passes = statistics()["passes"]
    assert passes.get("BakeWorld", {"drawn": 0})["drawn"] == passes["ShadeBackground"]["drawn"] == 0


@pytest.mark.parametrize("method", ["RAY_TRACED", "SHADOW_MAPS"])
def test_without_shadows_a_map_lights_surfaces_by_their_normals(place, method):
    """Where nothing hides the world: the ball is far above the floor, which is black."""
    place.scene.world = world_of(WORLDS["an image all around"])
    place.ball.location.z, place.scene.camera.location.z = 1000.0, 1003.0
    place.scene.ism.shadow.method = method
    place.scene.ism.shadow.world = place.scene.ism.shadow.sky_dome = False
    assert error(our_render(SAMPLES)[0]) <= BOUND
    assert statistics()["pairs_traced"] == statistics()["virtual_lights"] == 0


def test_virtual_lights_on_the_sky_dome_cast_shadows(place):
    """Measured: 0.026. Without shadows it would be 0.22, and with ambient occlusion in their place 0.21."""
    place.scene.world = world_of(clouds)
    for each in (place.floor, place.ball, place.block):
        each.data.materials.append(reflecting(**{"Specular IOR Level": 0.0}))
    shadow = place.scene.ism.shadow
    shadow.method, shadow.sky_dome = "SHADOW_MAPS", True
    assert error(our_render(4)[0]) <= 0.04
    assert statistics()["virtual_lights"] == place.scene.ism.render.virtual_lights
