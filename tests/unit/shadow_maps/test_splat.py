# SPDX-License-Identifier: GPL-3.0-or-later
"""Each texel of each imperfect shadow map against the nearest of all discs in that texel's direction."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.shadow_maps.atlas import batches
from ism_addon.gpu.passes.shadow_maps.select_points import MAP_POINT
from ism_addon.gpu.passes.shadow_maps.virtual_lights import virtual_light_tables
from ism_addon.resources import MAP_POINTS, NO_OCCLUDER, VIRTUAL_LIGHT_COUNTS
from tests.support.reference_maps import disc_map, map_directions
from tests.support.small_scenes import (
    draw,
    light,
    look_at,
    make_scene,
    quad,
    random_triangles,
    with_quality,
    with_shadow,
)

#: Fraction of texels whose direction passes a disc's rim too closely for float32. Measured: 0 to 1 in a thousand.
MAX_RIM_FRACTION = 2e-3


def maps(drawn, count: int, map_size: int, device) -> np.ndarray:
    """(S,side,side) the maps of a single batch."""
    (batch,) = batches(count, map_size, device.texture_size)
    atlas = drawn.target("shadow_map_splats")[..., 0]
    corners = [batch.corner(index) for index in range(count)]
    return np.array([atlas[y : y + batch.side, x : x + batch.side] for x, y in corners])


def true_maps(drawn, scene, view, settings, side: int) -> np.ndarray:
    """(S,side,side) maps of the same points and virtual lights, by numpy."""
    graph = drawn.renderer.graph
    anchor = drawn.renderer.frame(scene, view, settings, 0, drawn.profile).anchor
    _, _, points = virtual_light_tables(scene.lights, graph[VIRTUAL_LIGHT_COUNTS], 0, anchor)
    subsets, discs = graph[MAP_POINTS].ranges, np.frombuffer(graph[MAP_POINTS].buffer.read(), MAP_POINT)
    expected = []
    for index, point in enumerate(points):
        of_light = subsets[point["light"]]
        subset = of_light[index % len(of_light)]
        own = discs[subset.first : subset.first + subset.count]
        map_from_anchor = point["map_from_anchor"].astype(float)
        centres = (own["position"].astype(float) - point["position"]) @ map_from_anchor.T
        normals = own["normal"].astype(float) @ map_from_anchor.T
        expected.append(disc_map(centres, normals, own["radius"].astype(float), side, NO_OCCLUDER))
    return np.array(expected)


def wrong_fraction(ours: np.ndarray, truth: np.ndarray) -> float:
    """Fraction of the texels whose distance differs."""
    return float((~np.isclose(ours, truth, rtol=2e-3)).mean())


@pytest.mark.parametrize("height", [4.0, 1.2, 0.0], ids=["above", "close", "in the middle"])
@pytest.mark.parametrize("points", [60, 1500])
def test_maps_hold_the_nearest_disc_of_each_direction(device, height, points):
    lights = light(position=(0.1, 0.2, height), axis_u=(0.5, 0.1, 0.0), axis_v=(0.1, -0.5, 0.1))
    scene, view = make_scene([random_triangles()], lights), look_at((3.0, -3.0, 2.0))
    settings = with_quality(with_shadow(), virtual_lights=3, map_size=48, map_points=points)
    drawn = draw(device, scene, view, settings)
    ours, truth = maps(drawn, 3, 48, device), true_maps(drawn, scene, view, settings, 48)
    assert 0.01 < (truth < NO_OCCLUDER).mean() <= 1.0
    assert wrong_fraction(ours, truth) <= MAX_RIM_FRACTION


@pytest.mark.parametrize("size", [0.3, 1.0, 4.0])
def test_the_splat_size_is_the_discs_radius(device, size):
    scene, view = make_scene([random_triangles()], light()), look_at((3.0, -3.0, 2.0))
    settings = with_quality(with_shadow(splat_size=size), virtual_lights=2, map_size=64, map_points=300)
    drawn = draw(device, scene, view, settings)
    assert wrong_fraction(maps(drawn, 2, 64, device), true_maps(drawn, scene, view, settings, 64)) <= MAX_RIM_FRACTION


def test_discs_whose_centres_are_below_the_horizon_are_whole(device):
    """Rounding must not move a point's centre out of the map: OpenGL would discard the point."""
    inside = light(position=(0.1, 0.2, 0.0), axis_u=(0.5, 0.1, 0.0), axis_v=(0.1, -0.5, 0.1))
    scene, view = make_scene([random_triangles()], inside), look_at((3.0, -3.0, 2.0))
    settings = with_quality(with_shadow(), virtual_lights=64, map_size=48, map_points=60)
    drawn = draw(device, scene, view, settings)
    assert wrong_fraction(maps(drawn, 64, 48, device), true_maps(drawn, scene, view, settings, 48)) < 1e-4


@pytest.mark.parametrize("height", [0.03, 1e-3, 0.0, -1e-3, -0.03])
def test_discs_at_the_horizon(device, height):
    """A floor at the light's own height: only those parts of its discs that are above the horizon are in the map."""
    floor = quad((-2.0, -2.0, -height), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0))
    tilted = quad((0.5, -1.0, -0.4), (0.0, 2.0, 0.0), (0.3, 0.0, 1.0))
    lights = light(position=(0.0, 0.0, 0.0), axis_u=(0.1, 0.0, 0.0), axis_v=(0.0, -0.1, 0.0))
    scene, view = make_scene([floor, tilted], lights), look_at((3.0, -3.0, 2.0))
    settings = with_quality(with_shadow(), virtual_lights=2, map_size=48, map_points=800)
    drawn = draw(device, scene, view, settings)
    ours, truth = maps(drawn, 2, 48, device), true_maps(drawn, scene, view, settings, 48)
    assert wrong_fraction(ours, truth) <= 2 * MAX_RIM_FRACTION
    assert np.isfinite(ours).all()


def test_the_distance_is_that_of_the_plane_not_of_the_discs_centre(device):
    """A floor represented by few large discs: each covered texel has the floor's own distance."""
    floor = quad((-3.0, -3.0, 0.0), (6.0, 0.0, 0.0), (0.0, 6.0, 0.0))
    lights = light(position=(0.0, 0.0, 1.0), axis_u=(1e-3, 0.0, 0.0), axis_v=(0.0, -1e-3, 0.0))
    settings = with_quality(with_shadow(), virtual_lights=1, map_size=64, map_points=300)
    drawn = draw(device, make_scene([floor], lights), look_at((3.0, -3.0, 2.0)), settings)
    (ours,) = maps(drawn, 1, 64, device)
    expected = 1.0 / map_directions(64)[..., 2]
    covered = ours < NO_OCCLUDER
    assert covered.sum() > 1000
    assert ours[covered] == pytest.approx(expected[covered], rel=1e-3)


def test_a_disc_may_be_as_large_as_the_map(device):
    """Close to the light a disc covers the whole map, within the driver's largest point size."""
    lights = light(position=(0.0, 0.0, 0.2), axis_u=(1e-3, 0.0, 0.0), axis_v=(0.0, -1e-3, 0.0))
    scene, view = (
        make_scene([quad((-1.0, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0))], lights),
        look_at((3.0, -3.0, 2.0)),
    )
    settings = with_quality(with_shadow(splat_size=2.0), virtual_lights=1, map_size=120, map_points=20)
    drawn = draw(device, scene, view, settings)
    assert wrong_fraction(maps(drawn, 1, 120, device), true_maps(drawn, scene, view, settings, 120)) <= MAX_RIM_FRACTION


def test_instances_that_cast_no_shadow_are_not_splatted(device):
    scene = make_scene([random_triangles()], light(position=(0.0, 0.0, 4.0)))
    hidden = replace(scene, instances=replace(scene.instances, casts_shadow=np.zeros(1, bool)))
    drawn = draw(device, hidden, look_at((3.0, -3.0, 2.0)))
    assert drawn.profile.rows["SplatMaps"].drawn == 0
    assert drawn.profile.rows["SamplePoints"].drawn == 0
