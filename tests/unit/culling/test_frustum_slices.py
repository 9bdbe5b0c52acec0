# SPDX-License-Identifier: GPL-3.0-or-later
"""The boxes around what of others is in a picture: all that is seen lies in one, and they are not much larger."""

import numpy as np
import pytest

from ism_addon.gpu.culling.frustum_slices import MARGIN, visible_slices
from ism_addon.spaces import anchor_of, camera_position
from tests.support.small_scenes import draw, look_at, make_scene, random_triangles, transform, view_from_above


def all_within(points: np.ndarray, parts: np.ndarray, shrunk: float) -> bool:
    """Whether each of points (N,3) lies in one of the boxes (2,3,K), of which `shrunk` of their size is taken off."""
    less = shrunk * (parts[1] - parts[0])
    inside = (points[..., None] >= parts[0] + less) & (points[..., None] <= parts[1] - less)
    return bool(inside.all(1).any(1).all())


@pytest.mark.parametrize("seed", range(8))
def test_all_that_is_seen_is_in_them(device, seed):
    """Without their margin, which is for rays that start above what is seen."""
    random = np.random.default_rng(seed)
    places = np.stack([transform(random.normal(size=(3, 3)), 4.0 * random.normal(size=3)) for _ in range(80)])
    scene = make_scene([random_triangles(50, seed=seed)], None, places, np.zeros(80, int))
    size = (48, 32)
    view = look_at(6.0 * random.normal(size=3), random.normal(size=3), size) if seed % 4 else view_from_above(5.0, size)
    anchor = anchor_of(camera_position(view.view_from_world), scene.extent)
    low, high = scene.meshes[0].box
    corners = np.array([low, high])[np.indices((2, 2, 2)).reshape(3, -1), np.arange(3)[:, None]].T
    world = np.einsum("nij,kj->nki", places[:, :3, :3], corners) + places[:, None, :3, 3] - anchor
    boxes = np.stack([world.min(1).T, world.max(1).T])
    position = draw(device, scene, view).target("position")
    seen = position[position[..., 3] > 0.0][:, :3]
    assert len(seen) > 100
    parts = visible_slices(boxes, view, anchor)
    bare = MARGIN / (1.0 + 2.0 * MARGIN) - 1e-6
    assert all_within(seen, parts, bare)
    assert not all_within(seen, parts, 3.0 * bare), "they might be anything"


def test_what_is_beside_the_picture_is_in_none():
    wide = np.array([[-100.0, -100.0, -1.0], [100.0, 100.0, 0.0]])[..., None]
    low, high = visible_slices(wide, view_from_above(2.0), np.zeros(3))
    assert np.abs([low[:2], high[:2]]).max() < 1.0 + 2.0 * MARGIN + 0.2
    aside = np.array([[5.0, 5.0, -1.0], [6.0, 6.0, 0.0]])[..., None]
    assert visible_slices(aside, view_from_above(2.0), np.zeros(3)).shape == (2, 3, 0)
