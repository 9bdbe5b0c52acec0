# SPDX-License-Identifier: GPL-3.0-or-later
"""Visibility predicted from neighbours' rays: certain where they agree, and only from the same surface."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.direct.predict_visibility import PredictVisibility
from ism_addon.gpu.profile import Profile
from ism_addon.resources import POSITION, PREDICTED_VISIBILITY, PROBES
from tests.scenes.small import box_over_plane
from tests.support import reference
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    draw,
    light,
    make_scene,
    quad,
    read_texels,
    view_from_above,
    with_quality,
    write_texels,
)

FLOOR = quad((-10, -10, 0), (20, 0, 0), (0, 20, 0))
LIGHT = light(position=(0.0, 0.0, 5.0))
TENT = np.array([1.0, 2.0, 3.0, 2.0, 1.0]) / 3.0


def read_prediction(renderer) -> np.ndarray:
    """(H,W,2) visibility and uncertainty of the first light: 0 without a texture, as no ray to it was unoccluded."""
    size = renderer.graph.targets.sizes[POSITION]
    if 0 not in renderer.graph[PREDICTED_VISIBILITY]:
        return np.zeros((*size[::-1], 2))
    return read_texels(renderer.graph[PREDICTED_VISIBILITY][0], size).astype(float)


def predicted(device, scene, view, unoccluded: np.ndarray, traced: np.ndarray | None = None) -> np.ndarray:
    """(H,W,2) from given probes (H/2,W/2): their unoccluded rays and their traced rays, by default one each."""
    drawn = draw(device, scene, view)
    traced = np.ones_like(unoccluded) if traced is None else traced
    pairs = np.stack([unoccluded, traced], -1)
    write_texels(drawn.renderer.graph[PROBES][0], (255 * pairs).astype(np.uint8))
    drawn.renderer.graph.instance(PredictVisibility).execute(
        drawn.renderer.frame(scene, view, SMALL_SETTINGS, 0, Profile())
    )
    return read_prediction(drawn.renderer)


@pytest.mark.parametrize("size", [(32, 24), (17, 9), (1, 1)])
@pytest.mark.parametrize("visibility", [0.0, 1.0])
def test_where_all_neighbours_agree_the_prediction_is_certain(device, size, visibility):
    probes = np.full((-(-size[1] // 2), -(-size[0] // 2)), visibility)
    prediction = predicted(device, make_scene([FLOOR], LIGHT), view_from_above(4.0, size), probes)
    assert (prediction == (visibility, 0.0)).all()


def test_one_ray_that_differs_changes_predictions_up_to_two_probes_away(device):
    probes = np.ones((16, 16))
    probes[8, 5] = 0.0
    prediction = predicted(device, make_scene([FLOOR], LIGHT), view_from_above(4.0), probes)
    is_uncertain = np.zeros((32, 32), bool)
    is_uncertain[11:22, 5:16] = True  # two probes to each side, and the pixels between those and the next
    assert np.array_equal(prediction[..., 1] == 1.0, is_uncertain)
    expected = 1.0 - np.outer(TENT, TENT) / TENT.sum() ** 2
    # Rounded at the probes, and again at the pixels; OpenGL does not say which way.
    assert prediction[12:22:2, 6:16:2, 0] == pytest.approx(expected, abs=2**-10)
    assert (prediction[~is_uncertain] == (1.0, 0.0)).all()


def test_on_a_plane_neighbours_are_weighted_by_distance(device):
    """Random rays: the weighted mean of the nearest 25 at probes, interpolated linearly between probes."""
    probes = np.random.default_rng(0).integers(0, 2, (16, 16)).astype(float)
    prediction = predicted(device, make_scene([FLOOR], LIGHT), view_from_above(4.0), probes)
    padded = np.pad(probes, 2, mode="edge")
    weights = np.outer(TENT, TENT) / TENT.sum() ** 2
    means = sum(weights[y, x] * padded[y : y + 16, x : x + 16] for y in range(5) for x in range(5))
    positions = np.minimum(np.arange(32) / 2, 15)
    rows = np.array([np.interp(positions, np.arange(16), row) for row in means])
    interpolated = np.array([np.interp(positions, np.arange(16), column) for column in rows.T]).T
    # Rounded at the probes, and again at the pixels.
    assert prediction[..., 0] == pytest.approx(interpolated, abs=2**-10)


def test_no_visibility_is_taken_from_another_surface(device):
    """A raised plate on the left is in shadow and the floor is lit, also right beside the edge."""
    plate = quad((-10, -10, 1), (10 + 1 / 24, 0, 0), (0, 20, 0))
    scene, view = make_scene([FLOOR, plate], LIGHT), view_from_above(4.0, (48, 48))
    heights = draw(device, scene, view).target("position")[..., 2]
    on_plate = heights > heights.mean()
    prediction = predicted(device, scene, view, np.where(on_plate[::2, ::2], 0.0, 1.0))
    # The tolerance is for the small weight that all neighbours have, so that the sum of weights is never 0.
    assert prediction[..., 0] == pytest.approx(np.where(on_plate, 0.0, 1.0), abs=5e-4)
    assert prediction[..., 1].any()
    assert not prediction[..., 1].all()


def test_pixels_without_rays_are_not_counted(device):
    """Half of the neighbours traced no ray, and do not count as occluded."""
    rays = np.indices((16, 16)).sum(0) % 2
    prediction = predicted(device, make_scene([FLOOR], LIGHT), view_from_above(4.0), 1.0 * rays, 1.0 * rays)
    assert (prediction == (1.0, 0.0)).all()


def test_more_rays_make_better_predictions(device):
    """Compared with the visibility of the light in the reference image."""
    scene, view = box_over_plane(48, 32)
    open_scene = replace(scene, lights=replace(scene.lights, casts_shadow=np.array([False])))
    shadowed, unshadowed = (reference.picture(each, view, 10)[0][:, 0] for each in (scene, open_scene))
    ambient = 0.6 * scene.world.radiance[0]
    lit = unshadowed > 2.0 * ambient
    truth = (shadowed - ambient)[lit] / (unshadowed - ambient)[lit]
    settings, errors = with_quality(SMALL_SETTINGS, samples=256), []
    for last in (0, 16):
        visibility = read_prediction(draw(device, scene, view, settings, last=last).renderer)[..., 0].ravel()
        errors.append(np.sqrt(((visibility[lit] - truth) ** 2).mean()))
    assert errors[0] < 0.2
    assert errors[1] < 0.75 * errors[0]
