# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow rays correct any prediction: the mean is right, and there is no noise where nothing is to be corrected."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.direct.tiles_of_lights import CERTAIN_PROBABILITY, MAX_CERTAIN_PROBABILITY, TilesOfLights
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.resources import (
    LIGHT_INFLUENCE,
    PREDICTED_VISIBILITY,
    PREDICTION_SURFACE,
    SUM_COLOR,
    SUM_RESIDUAL,
    TILE_VISIBILITY,
    TILES,
)
from tests.scenes.small import box_over_plane, pillar_field
from tests.support import reference
from tests.support.small_scenes import (
    AREA_SHAPES,
    SMALL_SETTINGS,
    draw,
    join_lights,
    light,
    look_at,
    make_scene,
    quad,
    random_triangles,
    view_from_above,
    with_quality,
    write_texels,
)

FLOOR = quad((-3, -3, 0), (6, 0, 0), (0, 6, 0))


def means(renderer) -> tuple[np.ndarray, np.ndarray]:
    """(N,3) each: the mean prediction, and the mean residual of all samples but the first."""
    total, residuals = (
        renderer.graph.targets.read(target).reshape(-1, 4).astype(float) for target in (SUM_COLOR, SUM_RESIDUAL)
    )
    count = total[:, 3:]
    return total[:, :3] / count, residuals[:, :3] / (count - 1.0)


def means_with_prediction(
    device, scene, view, visibility: float, uncertainty: float, samples: int, until: int = 1 << 20
) -> tuple[np.ndarray, np.ndarray]:
    """`means` if these are predicted for each light everywhere, right or wrong, in samples before `until`."""
    settings = with_quality(SMALL_SETTINGS, samples=samples)
    renderer, profile = Renderer(device), Profile()
    for sample in range(samples):
        for name in renderer.sample(scene, view, settings, sample, profile):
            if name == "PredictVisibility" and sample < until:
                for texture in renderer.graph[PREDICTED_VISIBILITY].values():
                    pixels = np.tile(
                        np.array([visibility, uncertainty], np.float16), (texture.height, texture.width, 1)
                    )
                    texture.write(pixels)
                for tiles in renderer.graph[TILE_VISIBILITY].values():
                    tiles[:] = visibility > 0.0 or uncertainty > 0.0, visibility < 1.0 or uncertainty > 0.0
    return means(renderer)


@pytest.mark.parametrize("make", [box_over_plane, pillar_field], ids=["rectangle", "ellipse and spread"])
@pytest.mark.parametrize("visibility", [0.0, 0.4, 1.0])
def test_the_mean_is_right_whatever_is_predicted(device, make, visibility):
    scene, view = make(24, 16)
    truth = reference.picture_of(make, 24, 16, 16)
    predicted, residuals = means_with_prediction(device, scene, view, visibility, 1.0, 128)
    assert reference.nrmse(predicted, truth) > 0.1
    assert reference.nrmse(predicted + residuals, truth) < 0.03
    assert (predicted + residuals).mean() == pytest.approx(truth.mean(), rel=0.01)


@pytest.mark.parametrize("make", [box_over_plane, pillar_field], ids=["rectangle", "ellipse and spread"])
@pytest.mark.parametrize("visibility", [0.0, 1.0])
def test_a_wrong_prediction_that_is_certain_is_detected(device, make, visibility):
    """Rare rays detect it. Later predictions are right, and the first samples count less the more samples follow."""
    scene, view = make(24, 16)
    truth = reference.picture_of(make, 24, 16, 16)
    wrong, _ = means_with_prediction(device, scene, view, visibility, 0.0, 4, until=4)
    assert reference.nrmse(wrong, truth) > 0.1
    assert reference.nrmse(sum(means_with_prediction(device, scene, view, visibility, 0.0, 128, until=4)), truth) < 0.05


@pytest.mark.parametrize(("probability", "rays"), [(1 / 16, 1), (1 / 8, 2), (10.0, MAX_CERTAIN_PROBABILITY * 16)])
@pytest.mark.parametrize(
    ("visible", "exact"), [(True, True), (False, True), (False, False)], ids=["lit", "dark", "dark and not exact"]
)
def test_a_certain_tile_traces_rays_by_its_light_and_over_time_at_every_subpixel_offset(
    device, probability, rays, visible, exact
):
    """In `rays` of each 16 samples, which share a grid."""
    renderer, settings = Renderer(device), with_quality(SMALL_SETTINGS, samples=16)
    scene, view = box_over_plane(24, 16)
    for sample in range(2):
        list(renderer.sample(scene, replace(view, filter_width=1.5), settings, sample, Profile()))
    frame, _ = renderer.last
    tiles, count = frame[TILES], len(frame.grid.subpixel_offsets)
    frame[TILE_VISIBILITY][0][:] = visible, not visible
    influence = frame[LIGHT_INFLUENCE][0]
    for array, value in (
        (influence.contributes, True),
        (influence.is_faint, False),
        (influence.bound_over_mean, probability / CERTAIN_PROBABILITY),
    ):
        array[:] = value
    has_rays = np.zeros((64 * count, len(tiles)), int)
    for sample, in_sample in enumerate(has_rays):
        tiles["sample_index"] = sample
        traced, _ = TilesOfLights(frame).of_light(0, exact)
        in_sample += (tiles["tile"][:, None] == traced["tile"]).all(2).any(1)
    has_rays = has_rays.reshape(64, count, len(tiles))
    assert count == 16
    assert (has_rays.sum(1) == rays).all()
    assert has_rays.any(0).all()


def test_a_prediction_is_for_the_surface_that_the_sample_shows(device):
    """The edge of a lit plate over a shadowed floor crosses pixels. PREDICTION_SURFACE is what a sample shows there."""
    edge, sun = 0.3 * 4.0 / 32.0, light(position=(2, 0, 5), axis_u=(1e-3, 0, 0), axis_v=(0, -1e-3, 0), radiance=1e6)
    plate, roof = quad((-10, -10, 1), (10 + edge, 0, 0), (0, 20, 0)), quad((1.117, -10, 3), (20, 0, 0), (0, 20, 0))
    scene = make_scene([FLOOR, plate, roof], sun)
    scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, True, False])))
    view, settings = view_from_above(4.0, filter_width=1.5), with_quality(SMALL_SETTINGS, samples=16)
    renderer, profile = Renderer(device), Profile()
    for sample in range(16):
        for name in renderer.sample(scene, view, settings, sample, profile):
            if name == "PredictVisibility":
                surface = renderer.graph.targets.read(PREDICTION_SURFACE)
                lit = surface[..., 2] > surface[..., 2].mean()
                write_texels(renderer.graph[PREDICTED_VISIBILITY][0], np.stack([lit, 0 * lit], -1).astype(np.float16))
                renderer.graph[TILE_VISIBILITY][0][:] = True
    predicted, residuals = means(renderer)
    columns = predicted[:, 0].reshape(32, 32).mean(0)
    assert columns[14] > 0.0 == columns[19]
    assert 0.1 * columns[14] < columns[16] < 0.9 * columns[14], "samples of both surfaces"
    assert not residuals.any()


def test_more_samples_have_less_error(device):
    scene, view = box_over_plane(24, 16)
    truth = reference.picture_of(box_over_plane, 24, 16, 16)
    errors = [
        reference.nrmse(sum(means_with_prediction(device, scene, view, 0.5, 1.0, samples)), truth)
        for samples in (17, 65, 257)
    ]
    assert errors[1] < 0.6 * errors[0]
    assert errors[2] < 0.6 * errors[1]


@pytest.mark.parametrize("roof", [False, True], ids=["all seen", "all hidden"])
def test_no_noise_where_all_is_visible_or_occluded(device, roof):
    """All residuals are exactly 0."""
    meshes = [FLOOR, quad((-9, -9, 1.5), (18, 0, 0), (0, 18, 0))] if roof else [FLOOR]
    drawn = draw(
        device, make_scene(meshes, light()), view_from_above(4.0, height=1.2), with_quality(SMALL_SETTINGS, samples=16)
    )
    predicted, residuals = means(drawn.renderer)
    assert not residuals.any()
    assert predicted.any() == (not roof)


@pytest.mark.parametrize("shape", AREA_SHAPES)
@pytest.mark.parametrize("spread", [np.pi, 1.5, 0.4])
def test_without_shadows_all_light_arrives(device, shape, spread):
    """Lights without shadows, meshes that cast none, and shadows switched off: the same image as the reference."""
    area_light = light(shape, (0.5, 0.3, 2.0), (0.8, 0.0, 0.3), (0.0, -0.6, 0.0), spread=spread)
    scene, view = make_scene([FLOOR, random_triangles(20)], area_light), look_at((3.0, -3.0, 3.0))
    settings = with_quality(SMALL_SETTINGS, samples=3)
    open_scene = replace(scene, lights=replace(area_light, casts_shadow=np.array([False])))
    no_casters = replace(scene, instances=replace(scene.instances, casts_shadow=np.zeros(2, bool)))
    shadows_off = replace(settings, shadow=replace(settings.shadow, enabled=False))
    pictures = [
        means(draw(device, *arguments).renderer)
        for arguments in ((open_scene, view, settings), (no_casters, view, settings), (scene, view, shadows_off))
    ]
    truth, surface = reference.picture(open_scene, view, 40)
    for predicted, residuals in pictures:
        assert np.array_equal(predicted, pictures[0][0])
        assert not residuals.any()
    difference = np.abs(pictures[0][0] - truth)[surface.exists]
    assert np.quantile(difference, 0.97) < 0.01 * truth.max()


def test_lights_add_up(device):
    """One with a shadow and one without: the sum of each alone."""
    one, other = light(position=(1.0, 0.0, 2.0), casts_shadow=False), light(position=(-1.0, 0.0, 2.0), radiance=2.0)
    meshes, view = [FLOOR, quad((-0.5, -0.5, 1.0), (1, 0, 0), (0, 1, 0))], look_at((3.0, -3.0, 3.0))
    settings = with_quality(SMALL_SETTINGS, samples=128)
    together = sum(means(draw(device, make_scene(meshes, join_lights(one, other)), view, settings).renderer))
    separate = [sum(means(draw(device, make_scene(meshes, each), view, settings).renderer)) for each in (one, other)]
    assert separate[0].any()
    assert reference.nrmse(together, separate[0] + separate[1]) < 0.02


def test_the_first_sample_traces_no_rays(device):
    scene, view = box_over_plane(24, 16)
    drawn = draw(device, scene, view)
    assert drawn.target("direct_prediction").any()
    assert not drawn.target("direct_residual").any()
