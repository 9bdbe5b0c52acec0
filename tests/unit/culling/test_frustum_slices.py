# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounding boxes of what is in view: each visible point is in one, and they are not much larger."""

import numpy as np
import pytest

from ism_addon.gpu.culling.frustum_slices import MARGIN, visible_slices
from ism_addon.spaces import anchor_of, camera_position
from tests.support.small_scenes import draw, look_at, make_scene, random_triangles, transform, view_from_above


def all_within(points: np.ndarray, boxes: np.ndarray, fraction: float) -> bool:
    """Whether each of points (N,3) is in one of boxes (2,3,K), shrunk on each side by this fraction of their size."""
    inset = fraction * (boxes[1] - boxes[0])
    inside = (points[..., None] >= boxes[0] + inset) & (points[..., None] <= boxes[1] - inset)
    return bool(inside.all(1).any(1).all())


@pytest.mark.parametrize("seed", range(8))
def test_all_visible_points_are_in_the_boxes(device, seed):
    """Also without the margin of the boxes, which is for rays that start above visible surfaces."""
    random = np.random.default_rng(seed)
    transforms = np.stack([transform(random.normal(size=(3, 3)), 4.0 * random.normal(size=3)) for _ in range(80)])
    scene = make_scene([random_triangles(50, seed=seed)], None, transforms, np.zeros(80, int))
    size = (48, 32)
    view = look_at(6.0 * random.normal(size=3), random.normal(size=3), size) if seed % 4 else view_from_above(5.0, size)
    anchor = anchor_of(camera_position(view.view_from_world), scene.extent)
    low, high = scene.meshes[0].box
    corners = np.array([low, high])[np.indices((2, 2, 2)).reshape(3, -1), np.arange(3)[:, None]].T
    world = np.einsum("nij,kj->nki", transforms[:, :3, :3], corners) + transforms[:, None, :3, 3] - anchor
    boxes = np.stack([world.min(1).T, world.max(1).T])
    position = draw(device, scene, view).target("position")
    visible = position[position[..., 3] > 0.0][:, :3]
    assert len(visible) > 100
    slices = visible_slices(boxes, view, anchor)
    margin = MARGIN / (1.0 + 2.0 * MARGIN) - 1e-6
    assert all_within(visible, slices, margin)
    assert not all_within(visible, slices, 3.0 * margin), "the boxes are much too large"


def test_the_boxes_contain_nothing_out_of_view():
    wide = np.array([[-100.0, -100.0, -1.0], [100.0, 100.0, 0.0]])[..., None]
    low, high = visible_slices(wide, view_from_above(2.0), np.zeros(3))
    assert np.abs([low[:2], high[:2]]).max() < 1.0 + 2.0 * MARGIN + 0.2
    outside = np.array([[5.0, 5.0, -1.0], [6.0, 6.0, 0.0]])[..., None]
    assert visible_slices(outside, view_from_above(2.0), np.zeros(3)).shape == (2, 3, 0)
