# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera rays and shadow rays pass transparent surfaces, and opaque ones cost nothing."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.resources import POINT_CLOUD, POINT_GRAPHS, TRANSMITTED_COLOR
from ism_addon.scene import Image, LightShape
from ism_addon.shading.builder import Builder, Value, constant
from tests.scenes.parts.tables import materials_of
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    light,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)

SIZE = 24, 24
SAMPLES = 16
FLOOR = (0.5, 0.5, 0.5)
CLEAR = (1.0, 1.0, 1.0)


def even(color, tints=False):
    """The graph of a surface that is equally transparent everywhere, and its constants."""
    builder = Builder()
    return builder.finish([builder.call("closure_transparent", constant(color), parameter=int(tints))])


def by_image():
    """Transparent where image 0 is bright."""
    builder = Builder()
    color = builder.call("color_of", builder.call("image_closest", Value("image"), builder.call("uv_map")))
    return builder.finish([builder.call("closure_transparent", color)])


def by_object():
    """Transparent by the objects' color."""
    builder = Builder()
    return builder.finish([builder.call("closure_transparent", builder.call("color_of", builder.call("object_color")))])


def scene_of(camera, shadow, layers=1, color=(0.0, 0.0, 0.0), **others):
    """A floor under layers of a material, under a sun. `camera`, `shadow`: a graph and its constants each."""
    floor = quad((-2.0, -2.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0))
    above = [quad((-2.0, -2.0, 0.01 + 0.01 * k), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0)) for k in range(layers)]
    above = [replace(each, materials=np.ones(2, np.uint32)) for each in above]
    graphs = tuple(dict.fromkeys((camera[0], shadow[0])))
    first = 0, len(camera[1])
    materials = replace(
        materials_of([FLOOR, color]),
        constants=np.concatenate([camera[1], shadow[1]]),
        transparency=np.int32([[-1, -1], [graphs.index(each[0]) for each in (camera, shadow)]]),
        transparency_constant=np.int32([[-1, -1], first]),
    )
    sun = light(LightShape.SUN)
    return replace(make_scene([floor, *above], sun), materials=materials, graphs=graphs, **others)


#: All pixels take part in all samples.
EVENLY = replace(SMALL_SETTINGS, shortcuts=False)


def colors(device, scene, samples=SAMPLES, settings=EVENLY, filter_width=0.01):
    """(H,W,3) in the middle of the picture."""
    view = replace(view_from_above(3.0, SIZE), filter_width=filter_width)
    picture = draw(device, scene, view, with_quality(settings, samples=samples)).color
    return picture[4:-4, 4:-4, :3]


def bare(device):
    """The color of the floor without anything above it."""
    return colors(device, scene_of(even(CLEAR), even(CLEAR), layers=0), samples=1).mean((0, 1))


@pytest.mark.parametrize("layers", [1, 2, 3])
def test_shadow_rays_are_tinted_by_each_surface(device, layers):
    tint = np.array([0.9, 0.5, 0.25])
    scene = scene_of(even(CLEAR), even(tint), layers)
    # The first sample's prediction is grey.
    assert np.allclose(colors(device, scene) / bare(device), tint**layers, atol=0.01)


@pytest.mark.parametrize("layers", [1, 2, 3])
def test_the_camera_sees_tints_of_each_surface(device, layers):
    tint = np.array([1.0, 0.5, 0.25])
    ratio = colors(device, scene_of(even(tint, True), even(CLEAR), layers), 4) / bare(device)
    assert np.allclose(ratio, tint**layers, atol=1e-3), "as one component passes entirely, there is no noise"


def test_surfaces_tint_what_is_behind_them_alone(device):
    """Opaque surfaces among those that tint, and edges between the triangles of both."""
    tint = np.array([0.8, 0.4, 0.2])
    for color in (FLOOR, (0.0, 0.0, 0.0)):
        scene = scene_of(even(tint, True), even(CLEAR), color=color)
        ratio = colors(device, scene, 64).mean((0, 1)) / bare(device)
        assert np.allclose(ratio, tint + 0.2 * np.array(color) / FLOOR, atol=0.01)


def test_grey_surfaces_have_no_tint_and_no_other_shader(device):
    before = set(device.programs)
    drawn = draw(device, scene_of(even([0.5] * 3), even(CLEAR)), view_from_above(3.0, SIZE))
    assert not drawn.profile.rows["TransmittedColor"].drawn
    assert TRANSMITTED_COLOR not in drawn.renderer.graph.targets.sizes
    assert not [key for key in device.programs.keys() - before if ("tinted", 1) in key[-1]]


def test_only_instances_that_tint_are_drawn_again(device):
    counts = []
    for tints in (False, True):
        drawn = draw(device, scene_of(even([0.5] * 3, tints), even(CLEAR)), view_from_above(3.0, SIZE))
        counts.append(drawn.profile.counts["triangles_drawn"])
    assert counts == [4, 6]


def test_a_smaller_picture_with_tints_after_a_larger_one_without(device):
    """The depth buffer stays as large as it was."""
    grey, tinted = (scene_of(even([0.5] * 3, tints), even(CLEAR)) for tints in (False, True))
    larger = draw(device, grey, view_from_above(3.0, (40, 32)))
    again = draw(device, tinted, view_from_above(3.0, SIZE), renderer=larger.renderer)
    assert np.array_equal(again.color, draw(device, tinted, view_from_above(3.0, SIZE)).color)


def test_too_many_surfaces_are_opaque(device):
    for layers, passes in ((2, 1.0), (3, 0.0)):
        scene = scene_of(even(CLEAR), even(CLEAR), layers, transparent_bounces=2)
        assert np.allclose(colors(device, scene) / bare(device), passes, atol=0.02)


def test_a_pixel_has_the_mean_of_what_is_before_and_behind(device):
    row, column = np.indices((SIZE[1] - 8, SIZE[0] - 8))
    inside = np.abs(row - column) > 1
    for passing in (0.0, 0.3, 0.75, 1.0):
        ratio = colors(device, scene_of(even([passing] * 3), even(CLEAR))) / bare(device)
        # A pixel has one sample in each stratum of its random numbers, but where two triangles meet.
        assert np.abs(ratio - passing)[inside].max() <= 1.0 / SAMPLES + 1e-3
        assert abs(ratio.mean() - passing) < 0.005


def test_surfaces_behind_one_another_are_independent(device):
    ratio = colors(device, scene_of(even([0.5] * 3), even(CLEAR), layers=2)) / bare(device)
    assert abs(ratio.mean() - 0.25) < 0.01
    assert 0.03 < ratio.std() < np.sqrt(0.25 * 0.75 / SAMPLES)


def test_samples_that_share_a_grid_are_stratified(device):
    for samples in (4, 16):
        ratio = colors(device, scene_of(even([0.3] * 3), even(CLEAR)), samples, filter_width=1.5) / bare(device)
        unstratified = np.sqrt(0.3 * 0.7 / samples)
        assert ratio.std() < 0.5 * unstratified


def test_later_samples_have_other_random_numbers(device):
    few, many = (colors(device, scene_of(even([0.5] * 3), even(CLEAR), 2), n) / bare(device) for n in (16, 64))
    assert many.std() < 0.6 * few.std()


def test_images_cut_out(device):
    texels = np.zeros((2, 2, 4), np.uint8)
    texels[0, 0] = texels[1, 1] = 255
    cut = scene_of(by_image(), even((0.0, 0.0, 0.0)), images=(Image(texels),))
    picture = draw(device, cut, view_from_above(3.0, SIZE), with_quality(SMALL_SETTINGS, samples=SAMPLES))
    primitive = picture.target("primitive")[..., 0]
    on_layer = primitive > 2
    assert on_layer[6:10, 14:18].all() and on_layer[14:18, 6:10].all()
    assert not on_layer[6:10, 6:10].any() and not on_layer[14:18, 14:18].any()
    lit = colors(device, scene_of(even(CLEAR), by_image(), images=(Image(texels),))) / bare(device)
    assert np.allclose(lit[2:6, 2:6], 1.0, atol=0.05) and np.allclose(lit[2:6, 10:14], 0.0, atol=0.05)


def test_graphs_read_objects(device):
    scene = scene_of(even(CLEAR), by_object())
    instances = replace(
        scene.instances,
        color=np.float32([[0, 0, 0, 1], [0.5, 0.25, 0.75, 1]]),
        pass_index=np.zeros(2, np.int32),
        random=np.zeros(2, np.float32),
    )
    ratio = colors(device, replace(scene, instances=instances)) / bare(device)
    assert np.allclose(ratio, (0.5, 0.25, 0.75), atol=0.01)


@pytest.mark.parametrize("rays_first", [False, True])
def test_shadow_maps_have_fewer_points_on_transparent_surfaces(device, rays_first):
    """Also if rays have been traced before, so that triangles lie in the order of a BVH."""
    texels = np.zeros((2, 2, 4), np.uint8)
    texels[0, 0] = texels[1, 1] = 255
    for graph, fraction in ((even([0.75] * 3), 0.25), (by_image(), 0.5), (even(CLEAR), 0.0)):
        scene = scene_of(even(CLEAR), graph, images=(Image(texels),))
        rays = draw(device, scene, view_from_above(3.0, SIZE)) if rays_first else None
        renderer = rays.renderer if rays else None
        drawn = draw(device, scene, view_from_above(3.0, SIZE), SMALL_SHADOW_MAPS, renderer)
        cloud = drawn.renderer.graph[POINT_CLOUD]
        on_floor, on_layer = (int((cloud.instances == k).sum()) for k in (0, 1))
        assert abs(on_layer / on_floor - fraction) < 0.02
        if graph[0].uses("image"):
            x, y = (cloud.positions + drawn.renderer.last[0].anchor)[cloud.instances == 1, :2].T
            assert ((x > 0.0) != (y > 0.0)).mean() > 0.98


def test_opaque_scenes_have_no_tables_and_no_other_shader(device):
    scene = make_scene([quad((-2.0, -2.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0))], light())
    before = set(device.programs)
    drawn = draw(device, scene, view_from_above(3.0, SIZE), with_quality(SMALL_SETTINGS, samples=2))
    assert drawn.renderer.graph.get(POINT_GRAPHS) is None
    assert not drawn.profile.rows["UploadPointGraphs"].drawn
    assert not [key for key in device.programs.keys() - before if ("transparency", 1) in key[-1]]


def test_further_graphs_of_a_scene_compile_no_shader_of_rays_again(device):
    image = Image(np.zeros((2, 2, 4), np.uint8))
    scene, view = scene_of(even((0.5, 0.5, 0.5)), by_image(), images=(image,)), view_from_above(3.0, SIZE)
    draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=2))
    before = set(device.programs)
    table = scene.materials
    moved = replace(table, transparency=np.where(table.transparency < 0, -1, table.transparency + 1).astype(np.int32))
    other = replace(scene, graphs=(by_object()[0], *scene.graphs), materials=moved)
    draw(device, other, view, with_quality(SMALL_SETTINGS, samples=2))
    assert set(device.programs) == before


def test_opaque_meshes_of_a_scene_are_drawn_by_the_shader_of_opaque_ones(device):
    scene = scene_of(even(CLEAR), even(CLEAR))
    renderer = draw(device, scene, view_from_above(3.0, SIZE)).renderer
    passes = renderer.graph[POINT_GRAPHS].camera
    buffers = next(
        content for resource, content in renderer.graph.contents.items() if resource.name == "instance_buffers"
    )
    assert passes.constants["transparency"] == 1
    assert buffers.with_materials(scene.materials.transparency[:, 0] >= 0).tolist() == [False, True]
