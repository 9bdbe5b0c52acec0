# SPDX-License-Identifier: GPL-3.0-or-later
"""View frustum culling: no instance in view is culled, and few out of view are drawn."""

import numpy as np
import pytest

from ism_addon.gpu.culling.frustum_culling import in_view, runs
from tests.support.small_scenes import draw, look_at, make_scene, random_triangles, transform

#: A grid around the origin.
POSITIONS = np.array([(x, y, z) for x in (-6, 0, 6) for y in (-6, 0, 6) for z in (-6, 0, 6)], float)


def random_linear_map(generator: np.random.Generator) -> np.ndarray:
    """(3,3): any linear map, also one that mirrors or nearly flattens."""
    return generator.normal(size=(3, 3))


@pytest.mark.parametrize("perspective", [True, False])
def test_no_box_with_a_point_in_view_is_culled(perspective):
    generator = np.random.default_rng(3)
    half_sizes, matrices = generator.uniform(0.0, 2.0, (400, 3)), np.zeros((400, 4, 4))
    matrices[:] = [transform(random_linear_map(generator), generator.normal(size=3) * 8.0) for _ in range(400)]
    clip = np.array([[1.2, 0, 0, 0], [0, 1.9, 0, 0], [0, 0, -1.002, -0.2], [0, 0, -1, 0]])
    if not perspective:
        clip = np.diag([0.3, 0.4, -0.05, 1.0])
    clip_from_centre = clip @ matrices
    inside = half_sizes[:, None] * generator.uniform(-1.0, 1.0, (400, 500, 3))
    points = np.einsum("nij,nkj->nki", clip_from_centre, np.concatenate([inside, np.ones((400, 500, 1))], 2))
    has_visible_point = (np.abs(points[..., :3]) <= points[..., 3:]).all(2).any(1)
    is_kept = in_view(half_sizes, clip_from_centre, 0.01)
    assert 40 < has_visible_point.sum() < 360
    assert not (has_visible_point & ~is_kept).any()
    assert (is_kept & ~has_visible_point).sum() < 0.25 * len(is_kept), "too many boxes out of view are kept"


@pytest.mark.parametrize(
    ("chosen", "expected"),
    [([], []), ([0], []), ([1], [(0, 1)]), ([1, 1, 0, 1], [(0, 2), (3, 1)]), ([0, 1, 0, 0, 1, 1], [(1, 1), (4, 2)])],
)
def test_runs_hold_all_chosen_rows(chosen, expected):
    assert runs(np.array(chosen, bool), np.zeros(len(chosen), int)) == expected


def test_a_run_is_of_one_kind_and_rows_of_no_kind_are_in_none():
    kinds = np.array([0, 0, 1, 1, 1, -1, 2, 2])
    assert runs(np.array([0, 1, 1, 1, 0, 1, 1, 1], bool), kinds) == [(1, 1), (2, 2), (6, 2)]


def test_instances_out_of_view_are_not_drawn_and_the_picture_stays_the_same(device):
    """Many instances around the camera, drawn together and each alone."""
    matrices, triangles = np.array([transform(offset=position) for position in POSITIONS]), random_triangles(60)
    for target in ((0.0, 0.0, 0.0), (4.0, 30.0, 8.0)):
        view = look_at((0.5, -1.5, 2.0), target, (48, 32))
        together = draw(device, make_scene([triangles], None, matrices, [0] * len(matrices), world=1.0), view)
        assert 60 <= together.profile.counts["triangles_drawn"] < 0.6 * 60 * len(POSITIONS)
        alone = [draw(device, make_scene([triangles], None, matrix[None], [0], world=1.0), view) for matrix in matrices]
        nearest = np.min([drawn.target("depth") for drawn in alone], axis=0)
        assert (nearest < 1e9).any()
        assert np.array_equal(together.target("depth"), nearest)
