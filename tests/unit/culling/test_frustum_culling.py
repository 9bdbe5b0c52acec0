# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands beside the picture is not drawn; what reaches into it is."""

import numpy as np
import pytest

from ism_addon.gpu.culling.frustum_culling import in_view, runs
from tests.support.small_scenes import draw, look_at, make_scene, random_triangles, transform

#: A grid around the origin.
PLACES = np.array([(x, y, z) for x in (-6, 0, 6) for y in (-6, 0, 6) for z in (-6, 0, 6)], float)


def turned(generator: np.random.Generator) -> np.ndarray:
    """(3,3): any linear map, mirrored or flat as it may be."""
    return generator.normal(size=(3, 3))


@pytest.mark.parametrize("perspective", [True, False])
def test_no_box_with_a_point_in_the_picture_is_left_out(perspective):
    generator = np.random.default_rng(3)
    half_sizes, matrices = generator.uniform(0.0, 2.0, (400, 3)), np.zeros((400, 4, 4))
    matrices[:] = [transform(turned(generator), generator.normal(size=3) * 8.0) for _ in range(400)]
    clip = np.array([[1.2, 0, 0, 0], [0, 1.9, 0, 0], [0, 0, -1.002, -0.2], [0, 0, -1, 0]])
    if not perspective:
        clip = np.diag([0.3, 0.4, -0.05, 1.0])
    clip_from_centre = clip @ matrices
    inside = half_sizes[:, None] * generator.uniform(-1.0, 1.0, (400, 500, 3))
    points = np.einsum("nij,nkj->nki", clip_from_centre, np.concatenate([inside, np.ones((400, 500, 1))], 2))
    shown = (np.abs(points[..., :3]) <= points[..., 3:]).all(2).any(1)
    found = in_view(half_sizes, clip_from_centre, 0.01)
    assert 40 < shown.sum() < 360
    assert not (shown & ~found).any()
    assert (found & ~shown).sum() < 0.25 * len(found), "few others"


@pytest.mark.parametrize(
    ("chosen", "expected"),
    [([], []), ([0], []), ([1], [(0, 1)]), ([1, 1, 0, 1], [(0, 2), (3, 1)]), ([0, 1, 0, 0, 1, 1], [(1, 1), (4, 2)])],
)
def test_runs_are_all_that_is_chosen(chosen, expected):
    assert runs(np.array(chosen, bool), np.zeros(len(chosen), int)) == expected


def test_a_run_is_of_one_kind_and_what_is_of_none_is_in_no_run():
    kinds = np.array([0, 0, 1, 1, 1, -1, 2, 2])
    assert runs(np.array([0, 1, 1, 1, 0, 1, 1, 1], bool), kinds) == [(1, 1), (2, 2), (6, 2)]


def test_what_is_beside_the_picture_is_not_drawn_and_not_missed(device):
    """Many instances, seen from amid them, together and each alone."""
    matrices, stones = np.array([transform(offset=place) for place in PLACES]), random_triangles(60)
    for target in ((0.0, 0.0, 0.0), (4.0, 30.0, 8.0)):
        view = look_at((0.5, -1.5, 2.0), target, (48, 32))
        together = draw(device, make_scene([stones], None, matrices, [0] * len(matrices), world=1.0), view)
        assert 60 <= together.profile.counts["triangles_drawn"] < 0.6 * 60 * len(PLACES)
        alone = [draw(device, make_scene([stones], None, one[None], [0], world=1.0), view) for one in matrices]
        nearest = np.min([each.target("depth") for each in alone], axis=0)
        assert (nearest < 1e9).any()
        assert np.array_equal(together.target("depth"), nearest)
