# SPDX-License-Identifier: GPL-3.0-or-later
"""Emissive meshes light other surfaces as area lights would, are seen by the camera, and cost nothing if absent."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.resources import IRRADIANCE_CACHE
from ism_addon.scene import Lights, LightShape, Scene
from ism_addon.settings import Method, Shadow
from tests.pictures.test_picture import SETTINGS, without_shadows
from tests.scenes.parts.tables import instances_of, materials_of
from tests.scenes.small import mesh, sphere, subdivided_box
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    draw,
    light,
    look_at,
    make_scene,
    no_lights,
    quad,
    transform,
    view_from_above,
    with_quality,
)

FLOOR = quad((-4, -4, 0), (8, 0, 0), (0, 8, 0))
PLATE = quad((-0.5, -0.5, 1), (1, 0, 0), (0, 1, 0))
PANEL = quad((-0.4, -0.4, 2.0), (0, 0.8, 0), (0.8, 0, 0))
VIEW = view_from_above(4.0, (64, 64), height=0.9)
WARM = (4.0, 2.0, 1.0)


def panel(cells: int):
    """The same panel of 2 cells² triangles."""
    across = np.linspace(-0.4, 0.4, cells + 1)
    positions = np.concatenate([np.stack(np.meshgrid(across, across), -1), np.full((cells + 1, cells + 1, 1), 2.0)], 2)
    index = np.arange((cells + 1) ** 2).reshape(cells + 1, -1)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    return mesh(positions.reshape(-1, 3), np.stack([a, b, c, a, c, d], -1).reshape(-1, 3))


def lit_by(emitter, *others, lights: Lights | None = None, **changes) -> Scene:
    """The floor and others, grey, and a mesh that emits."""
    scene = make_scene([FLOOR, *others, replace(emitter, materials=np.ones(len(emitter.triangles), np.uint32))], lights)
    materials = materials_of([(0.6, 0.6, 0.6), (0.0, 0.0, 0.0)], emission=[(0.0, 0.0, 0.0), WARM])
    instances = instances_of(range(len(scene.meshes)), **changes)
    return replace(scene, materials=materials, instances=instances)


def lit_by_area() -> Scene:
    lamp = light(LightShape.RECTANGLE, (0.0, 0.0, 2.0), (0.8, 0.0, 0.0), (0.0, -0.8, 0.0))
    return make_scene([FLOOR, PLATE], replace(lamp, emission=np.array([WARM], np.float32)))


def picture(device, scene: Scene, method: Method = Method.RAY_TRACED, **quality) -> np.ndarray:
    return draw(device, scene, VIEW, with_quality(SETTINGS[method], **quality)).color[..., :3]


@pytest.fixture(scope="module")
def lit_by_area_light() -> dict[Method, np.ndarray]:
    """By method: the picture of the floor in the light of an area light, once drawn."""
    return {}


#: Methods, and cells along a panel's side. Of 6 it has a light BVH. Maps, which are slow, are left out once without it.
PANELS = [(Method.RAY_TRACED, 1), (Method.RAY_TRACED, 2), (Method.RAY_TRACED, 6)]
PANELS += [(Method.SHADOW_MAPS, 1), (Method.SHADOW_MAPS, 6)]


@pytest.mark.parametrize(("method", "cells"), PANELS)
def test_a_panel_lights_the_floor_as_an_area_light_does(device, lit_by_area_light, method, cells):
    """It emits upwards, too, where nothing is."""
    samples = 64 if method == Method.RAY_TRACED else 8
    if method not in lit_by_area_light:
        lit_by_area_light[method] = picture(device, lit_by_area(), method, samples=samples)
    theirs = lit_by_area_light[method]
    error = np.abs(picture(device, lit_by(panel(cells), PLATE), method, samples=samples) - theirs) / theirs.mean()
    assert error.mean() < (0.01 if method == Method.RAY_TRACED else 0.03), "the noise of both"


@pytest.mark.parametrize("cells", [1, 6])
def test_without_occluders_there_is_no_noise(device, cells):
    """After one sample. The irradiance cache interpolates between points half a metre apart here."""
    settings = with_quality(SETTINGS[Method.RAY_TRACED], samples=1)
    area = replace(lit_by_area(), meshes=(FLOOR, FLOOR))
    ours = draw(device, lit_by(panel(cells)), VIEW, settings).color[..., :3]
    theirs = draw(device, without_shadows(area), VIEW, settings).color[..., :3]
    assert np.allclose(ours, theirs, rtol=2e-3 if cells == 1 else 6e-3, atol=1e-5)


@pytest.mark.parametrize("method", Method)
def test_a_ball_lights_the_floor_as_a_point_light_of_its_size_does(device, method):
    """Within the difference of a sphere and its triangles."""
    ball, samples = sphere((0, 0, 1.5), 0.3, 64, 32), 8 if method == Method.RAY_TRACED else 1
    point = replace(
        light(LightShape.POINT, (0.0, 0.0, 1.5), radius=0.3),
        emission=np.array([WARM], np.float32) * np.float32(np.pi * 0.3**2),
    )
    ours = picture(device, lit_by(ball), method, samples=samples)
    theirs = picture(device, make_scene([FLOOR], point), method, samples=samples)
    assert np.abs(ours / theirs - 1.0).mean() < (0.006 if method == Method.RAY_TRACED else 0.02)


@pytest.mark.parametrize(
    "emitter", [PANEL, subdivided_box((-0.2, -0.2, 0.2), (0.2, 0.2, 0.5), 3)], ids=["panel", "box"]
)
def test_the_camera_sees_the_radiance(device, emitter):
    view = view_from_above(4.0, (64, 64), height=4.0)
    color = draw(device, lit_by(emitter), view, SMALL_SETTINGS).color[..., :3]
    assert np.allclose(color[31:33, 31:33], WARM)


def test_a_box_does_not_shadow_its_own_light(device):
    """Its far sides are hidden, but they do not count."""
    box = subdivided_box((-0.3, -0.3, 1.0), (0.3, 0.3, 1.4), 2)
    settings = with_quality(SETTINGS[Method.RAY_TRACED], samples=4)
    shadowed = draw(device, lit_by(box), VIEW, settings)
    unshadowed = draw(device, lit_by(box), VIEW, replace(settings, shadow=Shadow(enabled=False)))
    assert np.allclose(shadowed.color, unshadowed.color, rtol=1e-5)


def test_a_room_that_emits_lights_what_is_in_it(device):
    """A closed mesh around the scene: its inner side."""
    room = subdivided_box((-4, -4, -1), (4, 4, 3), 2)
    color = picture(device, lit_by(room), samples=4)
    assert np.allclose(color, 0.6 * np.array(WARM), rtol=0.02), "as a world of this radiance"


def test_a_room_that_emits_is_exact_with_few_triangles(device):
    color = picture(device, lit_by(subdivided_box((-4, -4, -1), (4, 4, 3), 1)), samples=1)
    assert np.allclose(color, 0.6 * np.array(WARM), rtol=1e-3)


@pytest.mark.parametrize(
    ("changes", "lit"),
    [
        ({"visible_diffuse": [True, False]}, False),
        ({"receivers": [-1, 0], "groups": [1, 0]}, True),
        ({"receivers": [-1, 0], "groups": [0, 1]}, False),
    ],
    ids=["not visible", "linked", "linked to others"],
)
def test_flags_and_links_of_the_object_are_those_of_its_light(device, changes, lit):
    color = picture(device, lit_by(PANEL, **changes), samples=1)
    assert (color > 0.0).all() == lit and (color > 0.0).any() == lit


#: Convex emitters of few and of many triangles, and of so many that each pixel near them is not in the cache.
CONVEX = {
    "a box": subdivided_box((-0.5, -0.6, 0.2), (0.6, 0.5, 0.9), 1),
    "a divided box": subdivided_box((-0.5, -0.6, 0.2), (0.6, 0.5, 0.9), 3),
    "a ball": sphere((0, 0, 0.5), 0.5, 24, 12),
}


@pytest.mark.parametrize("name", CONVEX)
def test_a_convex_mesh_does_not_light_itself(device, name):
    """Its triangles see each other at most edge-on, and not at all the one that they are in."""
    scene = lit_by(CONVEX[name])
    materials = materials_of([(0.6, 0.6, 0.6), (0.8, 0.8, 0.8)], emission=[(0.0, 0.0, 0.0), WARM])
    view = view_from_above(0.5, (24, 24), height=3.0)
    color = draw(device, replace(scene, materials=materials), view, with_quality(SMALL_SETTINGS, samples=16)).color
    np.testing.assert_allclose(color[..., :3], np.broadcast_to(WARM, (24, 24, 3)), rtol=5e-3)


BARS = [subdivided_box((x, -1.0, 1.02), (x + 0.1, 1.0, 1.1), 1) for x in (-0.6, 0.5)]


def test_pixels_near_a_light_bvh_are_as_bright_as_near_the_same_light_in_closed_form(device):
    """Bars beside panes see these from close by, where a light BVH's estimate is far off."""
    panes = {cells: replace(panel(cells), positions=panel(cells).positions * (1, 1, 0.5)) for cells in (2, 6)}
    settings = with_quality(SETTINGS[Method.RAY_TRACED], samples=32)
    few, many = (draw(device, lit_by(each, *BARS), VIEW, settings).color for each in panes.values())
    error = np.abs(few - many)[..., :3] / few[..., :3].mean()
    assert error.mean() < 0.02
    assert np.percentile(error, 99) < 0.15


def ridges(count: int, height: float):
    """A folded sheet, 1 m wide."""
    x = np.linspace(-0.5, 0.5, 2 * count + 1)
    fold = np.stack([x, np.full_like(x, -0.5), height * (np.arange(len(x)) % 2)], 1)
    a = np.arange(len(x) - 1)
    b, d = a + 1, a + len(x)
    return mesh(np.concatenate([fold, fold + (0.0, 1.0, 0.0)]), np.stack([a, b, d + 1, a, d + 1, d], 1).reshape(-1, 3))


def test_light_on_what_is_smaller_than_a_pixel_is_that_of_a_finer_picture(device):
    """Ridges close to a panel that the camera does not see: the panel's light differs on both sides of each."""
    low = replace(panel(6), positions=panel(6).positions * (1, 1, 0) + (0, 0, 0.12))
    scene = lit_by(low, ridges(20, 0.08), visible=[True, True, False])
    means = {}
    for side, samples in ((1, 64), (8, 8)):
        view = look_at((0.9, -1.2, 1.1), size=(32 * side, 24 * side), filter_width=1.5)
        settings = with_quality(SETTINGS[Method.RAY_TRACED], samples=samples)
        means[side] = draw(device, scene, view, settings).color[..., :3].mean()
    assert np.isclose(means[1], means[8], rtol=0.005)


@pytest.mark.parametrize("cached", [True, False])
def test_rays_correct_the_irradiance_close_to_a_light_of_many_triangles(device, cached):
    """Of a panel above the floor, where nothing occludes it, interpolated in the cache or estimated by a light BVH."""
    scenes = [
        lit_by(replace(panel(cells), positions=panel(cells).positions * (1, 1, 0.06)), visible=[True, False])
        for cells in (2, 12)
    ]
    truth, settings = picture(device, scenes[0], samples=1), with_quality(SETTINGS[Method.RAY_TRACED], samples=32)
    renderer, errors = Renderer(device), []
    for sample in range(settings.quality.samples):
        for name in renderer.sample(scenes[1], VIEW, settings, sample, Profile()):
            if name == "CacheIrradiance" and not cached:
                renderer.graph[IRRADIANCE_CACHE].clear()
        errors.append(np.abs(renderer.picture()[..., :3] - truth).mean() / truth.mean())
    assert errors[0] > 0.1
    assert errors[-1] < 0.02


def counts(device, scene: Scene, samples: int = 1):
    drawn = draw(device, scene, VIEW, with_quality(SMALL_SETTINGS, samples=samples))
    return drawn.profile, drawn.renderer


@pytest.mark.parametrize(
    ("scene", "caches"),
    [
        (make_scene([FLOOR], light()), 0),
        (lit_by(PANEL), 0),
        (lit_by(panel(6)), 1),
        (lit_by(panel(6), visible_diffuse=[True, False], lights=light()), 0),
    ],
    ids=["a lamp", "few triangles", "many", "without diffuse visibility"],
)
def test_only_a_light_bvh_needs_the_irradiance_cache(device, scene, caches):
    assert counts(device, scene)[0].rows["CacheIrradiance"].drawn == caches


def test_a_mesh_that_lights_nothing_in_view_is_not_in_the_cache(device):
    """Below the floor, all of which is in the shadow of its own front."""
    _, renderer = counts(device, lit_by(sphere((0, 0, -2.0), 0.5, 16, 8)))
    assert not renderer.graph.contents or not any(
        value for resource, value in renderer.graph.contents.items() if resource.name == "irradiance_cache"
    )


def test_black_surfaces_have_no_irradiance_in_the_cache(device):
    scene = lit_by(panel(12))
    black = replace(scene, materials=replace(scene.materials, base_color=np.zeros_like(scene.materials.base_color)))
    cached = [
        (np.frombuffer(cache.texture.read(alignment=1), cache.texture.dtype) >= 0.0).any()
        for each in (scene, black)
        for cache in counts(device, each)[1].graph[IRRADIANCE_CACHE].values()
    ]
    assert cached == [True, False]


def test_moving_something_else_uploads_no_emitters_again(device):
    scene = lit_by(panel(6), PLATE)
    profile, renderer = counts(device, scene)
    matrices = scene.instances.world_from_object.copy()
    matrices[1, 0, 3] += 0.1
    moved = replace(scene, instances=replace(scene.instances, world_from_object=matrices))
    again = draw(device, moved, VIEW, SMALL_SETTINGS, renderer)
    assert again.profile.rows["UploadLights"].drawn == 0
    matrices = matrices.copy()
    matrices[2, 0, 3] += 0.1
    moved = replace(scene, instances=replace(scene.instances, world_from_object=matrices))
    again = draw(device, moved, VIEW, SMALL_SETTINGS, renderer)
    assert again.profile.rows["UploadLights"].drawn == 1
    assert profile.rows["UploadLights"].drawn == 1


def test_a_moved_mesh_lights_from_where_it_is(device):
    scene = lit_by(PANEL, PLATE)
    _, renderer = counts(device, scene)
    matrices = np.array([transform(), transform(), transform(offset=(0.5, 0.0, 0.0))])
    moved = replace(scene, instances=replace(scene.instances, world_from_object=matrices))
    again = draw(device, moved, VIEW, SMALL_SETTINGS, renderer).color
    assert np.array_equal(again, draw(device, moved, VIEW, SMALL_SETTINGS).color)


def test_nothing_emits_without_emissive_materials(device):
    scene = replace(lit_by(PANEL), materials=materials_of([(0.6, 0.6, 0.6)] * 2))
    assert not draw(device, scene, VIEW, SMALL_SETTINGS).color[..., :3].any()
    assert scene.lights.equals(no_lights())
