# SPDX-License-Identifier: GPL-3.0-or-later
"""Which tiles a sample draws: all at first, then mostly those that have a high variance."""

import functools
from itertools import pairwise

import numpy as np
import pytest

from ism_addon.gpu.gl.render_targets import pixels
from ism_addon.gpu.passes.surfaces import select_tiles
from ism_addon.gpu.passes.surfaces.select_tiles import (
    DARKEST,
    FULL_RATE_LIGHTS,
    MIN_NEIGHBOUR_RATIO,
    MIN_TILE_PROBABILITY,
    UNIFORM_SAMPLES,
)
from ism_addon.resources import RAY_COUNTS, SAMPLES_PER_TILE, TILE_SIZE
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    join_lights,
    light,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)

#: Lights with which tiles are drawn at full rate, and with which they are not.
FEW, MANY = int(FULL_RATE_LIGHTS) // 2, 5 * int(FULL_RATE_LIGHTS)

FLOOR = quad((-100, -100, 0), (200, 0, 0), (0, 200, 0))


def sample_counts(drawn) -> np.ndarray:
    """(rows,columns): the samples of each tile."""
    return drawn.renderer.graph[SAMPLES_PER_TILE]


def test_the_first_samples_draw_all_tiles_and_later_ones_do_not(device):
    scene, view = box_over_plane(64, 48)
    settings = with_quality(SMALL_SETTINGS, samples=16)
    for sample in range(UNIFORM_SAMPLES):
        assert draw(device, scene, view, settings, last=sample).drawn_tiles.all()
    assert not draw(device, scene, view, settings, last=UNIFORM_SAMPLES).drawn_tiles.all()


def test_counts_are_those_of_the_samples_drawn(device):
    scene, view = box_over_plane(64, 48)
    settings, total = with_quality(SMALL_SETTINGS, samples=16), np.zeros((6, 8))
    for sample in range(16):
        drawn = draw(device, scene, view, settings, last=sample)
        total += drawn.drawn_tiles
        assert np.array_equal(sample_counts(drawn), total)
    assert total.min() < 16


def test_all_tiles_gather_shadow_maps_in_all_samples(device):
    scene, view = box_over_plane(32, 16)
    drawn = draw(device, scene, view, with_quality(SMALL_SHADOW_MAPS, samples=12))
    assert (sample_counts(drawn) == 12).all()


def test_a_picture_without_variance_draws_few_tiles(device):
    """A floor lit by the world only: no two samples differ."""
    view, settings = view_from_above(4.0, (160, 160)), with_quality(SMALL_SETTINGS, samples=64)
    drawn = draw(device, make_scene([FLOOR], world=0.5), view, settings)
    expected = UNIFORM_SAMPLES + MIN_TILE_PROBABILITY * (64 - UNIFORM_SAMPLES)
    assert sample_counts(drawn) == pytest.approx(expected, abs=3.0)
    assert sample_counts(drawn).mean() == pytest.approx(expected, abs=0.5)


def under_lights(device, count: int, last: int):
    """A box below lights in a ring, together as bright whatever their number, drawn up to a sample of 16."""
    angles = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    lights = (
        light(
            position=(2.0 * np.cos(angle), 2.0 * np.sin(angle), 3.0),
            axis_u=(0.3, 0.0, 0.0),
            axis_v=(0.0, -0.3, 0.0),
            radiance=10.0 / count,
        )
        for angle in angles
    )
    scene, view = box_over_plane(128, 96)
    scene = make_scene(scene.meshes, functools.reduce(join_lights, lights))
    return draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=16), last=last)


def test_with_many_lights_fewer_tiles_are_drawn(device):
    few, many = (sample_counts(under_lights(device, count, last=15)).mean() for count in (FEW, MANY))
    assert many < 0.8 * few


def test_the_visibility_of_many_lights_is_not_predicted_for_few_draws(device):
    """It is predicted for the surfaces of a sample: of the fifth and later ones, or of later ones only."""
    for count, samples in ((FEW, [True, True]), (MANY, [False, True])):
        surfaces = [under_lights(device, count, last).target("prediction_surface") for last in (3, 4, 16)]
        assert [not np.array_equal(*pair) for pair in pairwise(surfaces)] == samples


def test_tiles_with_variance_are_drawn_most(device):
    """Tiles with a penumbra, below a plate, against those without. All of them are drawn sometimes."""
    plate = quad((-0.5, -0.5, 1.0), (1, 0, 0), (0, 1, 0))
    scene, view = (
        make_scene([FLOOR, plate], light(axis_u=(0.5, 0, 0), axis_v=(0, -0.5, 0))),
        view_from_above(8.0, (96, 96)),
    )
    drawn = draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=64))
    varies = drawn.target("sum_residual")[..., 3].reshape(12, TILE_SIZE, 12, TILE_SIZE).max((1, 3)) > 0.0
    assert 4 <= varies.sum() < 72
    assert sample_counts(drawn)[varies].mean() > 1.5 * sample_counts(drawn)[~varies].mean()
    assert sample_counts(drawn)[varies].max() == 64
    assert sample_counts(drawn).min() > UNIFORM_SAMPLES


@pytest.mark.parametrize("power", [0.2, 5.0, 40.0])
def test_a_sample_draws_at_least_a_fraction_of_the_tiles(monkeypatch, power):
    """However few of them have nearly all of the variance. Where enough tiles are drawn anyway, nothing changes."""
    least, means = select_tiles.MIN_MEAN_PROBABILITY, []
    deviation, unconverged = np.random.default_rng(1).random((60, 80)) ** power, np.ones((60, 80), bool)
    for name in ("MIN_MEAN_PROBABILITY", "MIN_NEIGHBOUR_RATIO", "MIN_TILE_PROBABILITY"):
        monkeypatch.setattr(select_tiles, name, 1e-9)
    for minimum in (1e-9, least):
        monkeypatch.setattr(select_tiles, "MIN_MEAN_PROBABILITY", minimum)
        means.append(select_tiles.allocate(deviation, 1e-30, unconverged, 1.0).mean())
    assert means[1] == pytest.approx(max(means[0], least), rel=0.01)
    assert (means[0] > least) == (power < 1.0)


def test_dark_tiles_have_more_rays_than_their_change_alone_asks_for(device, monkeypatch):
    """Lights above plates, one of them much fainter than the others."""
    assert select_tiles.tolerance(np.float32([1e-6, 0.002, 2.0, 2.0])) == pytest.approx([DARKEST**0.5] * 2 + [1.0] * 2)
    powers, rays = {-12.0: 1.0, -7.0: 1.0, -2.0: 1.0, 12.0: 0.03}, {}
    plates = [quad((x - 0.5, -0.5, 1.0), (1, 0, 0), (0, 1, 0)) for x in powers]
    lights = functools.reduce(join_lights, (light(position=(x, 0, 2), radiance=power) for x, power in powers.items()))
    scene, view = make_scene([FLOOR, *plates], lights), view_from_above(30.0, (240, 64))
    for darkest in (DARKEST, 1.0):
        monkeypatch.setattr(select_tiles, "DARKEST", darkest)
        drawn = draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=64))
        rays[darkest] = pixels(drawn.renderer.graph[RAY_COUNTS][3])[:64, 192:240, 1].sum()
    assert rays[DARKEST] > 1.5 * rays[1.0] > 0.0


def test_neighbours_of_tiles_with_variance_are_drawn_often(device):
    """An edge in one column of tiles. Its neighbours have no variance, but their samples count for its pixels."""
    plate = quad((-50.0, -50.0, 0.0), (50.0, 0.0, 0.0), (0.0, 100.0, 0.0))
    view = view_from_above(2.0, (56, 8), filter_width=1.5, transparent=True)
    counts = sample_counts(
        draw(device, make_scene([plate], world=1.0), view, with_quality(SMALL_SETTINGS, samples=64))
    )[0]
    assert counts[3] == 64
    assert (counts[[2, 4]] > 0.9 * MIN_NEIGHBOUR_RATIO * 64).all()
    assert (counts[[0, 1, 5, 6]] < 0.5 * MIN_NEIGHBOUR_RATIO * 64).all()


@pytest.mark.parametrize("size", [(1, 1), (7, 9), (8, 16), (17, 3), (1, 30)])
def test_pictures_whose_sides_are_no_multiples_of_a_tile(device, size):
    """No pixel is left out or drawn twice: a plain floor has one colour, for each sample count."""
    for samples in (1, 16):
        drawn = draw(
            device,
            make_scene([FLOOR], world=0.5),
            view_from_above(4.0, size),
            with_quality(SMALL_SETTINGS, samples=samples),
        )
        assert sample_counts(drawn).shape == (-(-size[1] // TILE_SIZE), -(-size[0] // TILE_SIZE))
        assert drawn.color == pytest.approx(np.broadcast_to([0.3, 0.3, 0.3, 1.0], (*size[::-1], 4)), abs=1e-3)
