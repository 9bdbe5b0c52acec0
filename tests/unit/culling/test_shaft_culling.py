# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaft culling: a box is kept exactly if a line between points of two other boxes meets it."""

import numpy as np

from ism_addon.gpu.culling.shaft_culling import meets_shaft


def random_boxes(random: np.random.Generator, count: int, extent: float, size: float) -> np.ndarray:
    """(2,3,count) boxes, some of them flat or a point."""
    middle = random.uniform(-extent, extent, (3, count))
    half = random.uniform(0.0, size, (3, count)) * (random.random((3, count)) < 0.8)
    return np.stack([middle - half, middle + half])


def random_points(random: np.random.Generator, boxes: np.ndarray, count: int) -> np.ndarray:
    """(count,3,N) points in boxes (2,3,N), many of them corners."""
    fraction = np.clip(random.uniform(-0.5, 1.5, (count, *boxes.shape[1:])), 0.0, 1.0)
    return boxes[0] + fraction * (boxes[1] - boxes[0])


def test_no_box_on_a_line_between_two_boxes_is_culled():
    random = np.random.default_rng(0)
    ones, others = random_boxes(random, 300, 5.0, 2.0), random_boxes(random, 300, 5.0, 2.0)
    starts, ends = random_points(random, ones, 40), random_points(random, others, 40)
    for t in random.random((20, 40, 1, 1)):
        on_lines = starts + t * (ends - starts)
        for first in range(0, 300, 20):  # a call tests each point against all its pairs: few at a time
            pairs = slice(first, first + 20)
            points = on_lines[..., pairs].transpose(1, 0, 2).reshape(3, -1)
            tiny_boxes = np.stack([points - 1e-9, points + 1e-9])
            is_kept = meets_shaft(tiny_boxes, ones[..., pairs], others[..., pairs])
            pair = np.tile(np.arange(20), 40)
            assert is_kept[np.arange(len(pair)), pair].all()


def test_a_box_that_no_line_meets_is_culled():
    """Compared with separating planes: if both other boxes are on the opposite side of one, no line meets the box."""
    random = np.random.default_rng(1)
    boxes, ones, others = (random_boxes(random, 60, 5.0, 1.0) for _ in range(3))
    normals = random.normal(size=(20_000, 3))
    normals[:6_000, random.integers(0, 3)] = 0.0  # as the sides of shafts are
    nearest = normals @ (boxes.sum(0) / 2.0) - np.abs(normals) @ ((boxes[1] - boxes[0]) / 2.0)
    farthest = np.maximum(
        *(normals @ (box.sum(0) / 2.0) + np.abs(normals) @ ((box[1] - box[0]) / 2.0) for box in (ones, others))
    )
    is_separated = np.array([(nearest[:, [k]] > farthest).any(0) for k in range(boxes.shape[2])])
    is_kept = meets_shaft(boxes, ones, others)
    assert not (is_kept & is_separated).any()
    assert 0.02 < is_kept.mean() < 0.5
    assert (is_kept | is_separated).mean() > 0.97, "the planes tried separate too few boxes"


def test_a_box_behind_either_end_is_culled():
    one, other = np.array([[[0.0], [0.0], [0.0]], [[1.0], [1.0], [0.0]]]), np.array([[[5.0]] * 3, [[6.0]] * 3])
    beyond = np.array([[7.0, 7.0, 7.0], [8.0, 8.0, 8.0]])
    before = np.array([[-1.0, -1.0, -1.0], [2.0, 2.0, -0.1]])
    beside = np.array([[0.0, 4.0, 2.0], [1.5, 5.0, 3.0]])
    inside = np.array([[2.5, 2.5, 2.5], [2.6, 2.6, 2.6]])
    boxes = np.stack([beyond, before, beside, inside], 2)
    assert meets_shaft(boxes, one, other).ravel().tolist() == [False, False, False, True]
