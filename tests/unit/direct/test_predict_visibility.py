# SPDX-License-Identifier: GPL-3.0-or-later
"""What neighbours' rays say of a pixel: sure where they agree, in doubt where not, and nothing across edges."""

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
LAMP = light(position=(0.0, 0.0, 5.0))
TENT = np.array([1.0, 2.0, 3.0, 2.0, 1.0]) / 3.0


def prediction(renderer) -> np.ndarray:
    """(H,W,2) of the first light; of one that no ray saw, none is kept."""
    size = renderer.graph.targets.sizes[POSITION]
    if 0 not in renderer.graph[PREDICTED_VISIBILITY]:
        return np.zeros((*size[::-1], 2))
    return read_texels(renderer.graph[PREDICTED_VISIBILITY][0], size).astype(float)


def predicted(device, scene, view, arrived: np.ndarray, rays: np.ndarray | None = None) -> np.ndarray:
    """(H,W,2) from what was scouted by hand: rays (H/2,W/2) that arrived, of one each."""
    drawn = draw(device, scene, view)
    rays = np.ones_like(arrived) if rays is None else rays
    pairs = np.stack([arrived, rays], -1)
    write_texels(drawn.renderer.graph[PROBES][0], (255 * pairs).astype(np.uint8))
    drawn.renderer.graph.instance(PredictVisibility).execute(
        drawn.renderer.frame(scene, view, SMALL_SETTINGS, 0, Profile())
    )
    return prediction(drawn.renderer)


@pytest.mark.parametrize("size", [(32, 24), (17, 9), (1, 1)])
@pytest.mark.parametrize("part", [0.0, 1.0])
def test_where_all_neighbours_agree_there_is_no_doubt(device, size, part):
    rows = np.full((-(-size[1] // 2), -(-size[0] // 2)), part)
    found = predicted(device, make_scene([FLOOR], LAMP), view_from_above(4.0, size), rows)
    assert (found == (part, 0.0)).all()


def test_one_ray_that_differs_is_felt_two_pixels_around_it(device):
    rows = np.ones((16, 16))
    rows[8, 5] = 0.0
    found = predicted(device, make_scene([FLOOR], LAMP), view_from_above(4.0), rows)
    doubt = np.zeros((32, 32), bool)
    doubt[11:22, 5:16] = True  # two scouts to all sides, and the pixels between those and the next
    assert np.array_equal(found[..., 1] == 1.0, doubt)
    felt = 1.0 - np.outer(TENT, TENT) / TENT.sum() ** 2
    assert found[12:22:2, 6:16:2, 0] == pytest.approx(felt, abs=2**-11)
    assert (found[~doubt] == (1.0, 0.0)).all()


def test_on_a_plane_neighbours_count_by_how_near_they_are(device):
    """Random rays: the mean of the 25 that are nearest; between scouts, the means between theirs."""
    rows = np.random.default_rng(0).integers(0, 2, (16, 16)).astype(float)
    found = predicted(device, make_scene([FLOOR], LAMP), view_from_above(4.0), rows)
    padded = np.pad(rows, 2, mode="edge")
    weights = np.outer(TENT, TENT) / TENT.sum() ** 2
    means = sum(weights[y, x] * padded[y : y + 16, x : x + 16] for y in range(5) for x in range(5))
    places = np.minimum(np.arange(32) / 2, 15)
    rows = np.array([np.interp(places, np.arange(16), row) for row in means])
    between = np.array([np.interp(places, np.arange(16), column) for column in rows.T]).T
    assert found[..., 0] == pytest.approx(between, abs=2**-10)  # rounded at the scouts, and again


def test_nothing_is_taken_from_another_surface(device):
    """A raised plate on the left is dark, the floor is lit: also beside the edge."""
    plate = quad((-10, -10, 1), (10 + 1 / 24, 0, 0), (0, 20, 0))
    scene, view = make_scene([FLOOR, plate], LAMP), view_from_above(4.0, (48, 48))
    heights = draw(device, scene, view).target("position")[..., 2]
    on_plate = heights > heights.mean()
    found = predicted(device, scene, view, np.where(on_plate[::2, ::2], 0.0, 1.0))
    # But for the little weight that all neighbours have, so that none are left without any.
    assert found[..., 0] == pytest.approx(np.where(on_plate, 0.0, 1.0), abs=5e-4)
    assert found[..., 1].any()
    assert not found[..., 1].all()


def test_pixels_without_rays_are_not_counted(device):
    """Half of the neighbours had no ray: those are no shadow."""
    rays = np.indices((16, 16)).sum(0) % 2
    found = predicted(device, make_scene([FLOOR], LAMP), view_from_above(4.0), 1.0 * rays, 1.0 * rays)
    assert (found == (1.0, 0.0)).all()


def test_more_rays_make_better_predictions(device):
    """Against the part of the light that the reference sees."""
    scene, view = box_over_plane(48, 32)
    open_scene = replace(scene, lights=replace(scene.lights, casts_shadow=np.array([False])))
    shaded, whole = (reference.picture(each, view, 10)[0][:, 0] for each in (scene, open_scene))
    ambient = 0.6 * scene.world.radiance[0]
    lit = whole > 2.0 * ambient
    truth = (shaded - ambient)[lit] / (whole - ambient)[lit]
    settings, errors = with_quality(SMALL_SETTINGS, samples=256), []
    for last in (0, 16):
        found = prediction(draw(device, scene, view, settings, last=last).renderer)[..., 0].ravel()
        errors.append(np.sqrt(((found[lit] - truth) ** 2).mean()))
    assert errors[0] < 0.2
    assert errors[1] < 0.75 * errors[0]
