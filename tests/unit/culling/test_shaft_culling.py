# SPDX-License-Identifier: GPL-3.0-or-later
"""What can stand between two boxes: all that a line meets from a point of one to a point of the other, and no more."""

import numpy as np

from ism_addon.gpu.culling.shaft_culling import meets_shaft


def some_boxes(random: np.random.Generator, count: int, reach: float, size: float) -> np.ndarray:
    """(2,3,count), some of them flat or a point."""
    middle = random.uniform(-reach, reach, (3, count))
    half = random.uniform(0.0, size, (3, count)) * (random.random((3, count)) < 0.8)
    return np.stack([middle - half, middle + half])


def within(random: np.random.Generator, boxes: np.ndarray, count: int) -> np.ndarray:
    """(count,3,N) points in boxes (2,3,N), many of them corners."""
    part = np.clip(random.uniform(-0.5, 1.5, (count, *boxes.shape[1:])), 0.0, 1.0)
    return boxes[0] + part * (boxes[1] - boxes[0])


def test_no_box_on_a_line_between_two_is_missed():
    random = np.random.default_rng(0)
    ones, others = some_boxes(random, 300, 5.0, 2.0), some_boxes(random, 300, 5.0, 2.0)
    starts, ends = within(random, ones, 40), within(random, others, 40)
    for at in random.random((20, 40, 1, 1)):
        on_lines = starts + at * (ends - starts)
        for first in range(0, 300, 20):  # each point is asked about with all pairs of a call: few at a time
            pairs = slice(first, first + 20)
            points = on_lines[..., pairs].transpose(1, 0, 2).reshape(3, -1)
            around = np.stack([points - 1e-9, points + 1e-9])
            found = meets_shaft(around, ones[..., pairs], others[..., pairs])
            pair = np.tile(np.arange(20), 40)
            assert found[np.arange(len(pair)), pair].all()


def test_what_no_line_meets_is_left_out():
    """Against planes: where one has a box on its one side, and both others on the other side, no line meets it."""
    random = np.random.default_rng(1)
    boxes, ones, others = (some_boxes(random, 60, 5.0, 1.0) for _ in range(3))
    normals = random.normal(size=(20_000, 3))
    normals[:6_000, random.integers(0, 3)] = 0.0  # as the sides of shafts are
    nearest = normals @ (boxes.sum(0) / 2.0) - np.abs(normals) @ ((boxes[1] - boxes[0]) / 2.0)
    farthest = np.maximum(
        *(normals @ (box.sum(0) / 2.0) + np.abs(normals) @ ((box[1] - box[0]) / 2.0) for box in (ones, others))
    )
    apart = np.array([(nearest[:, [k]] > farthest).any(0) for k in range(boxes.shape[2])])
    found = meets_shaft(boxes, ones, others)
    assert not (found & apart).any()
    assert 0.02 < found.mean() < 0.5
    assert (found | apart).mean() > 0.97, "the planes tried do not tell enough apart"


def test_what_is_behind_either_is_left_out():
    one, other = np.array([[[0.0], [0.0], [0.0]], [[1.0], [1.0], [0.0]]]), np.array([[[5.0]] * 3, [[6.0]] * 3])
    beyond = np.array([[7.0, 7.0, 7.0], [8.0, 8.0, 8.0]])
    before = np.array([[-1.0, -1.0, -1.0], [2.0, 2.0, -0.1]])
    beside = np.array([[0.0, 4.0, 2.0], [1.5, 5.0, 3.0]])
    inside = np.array([[2.5, 2.5, 2.5], [2.6, 2.6, 2.6]])
    boxes = np.stack([beyond, before, beside, inside], 2)
    assert meets_shaft(boxes, one, other).ravel().tolist() == [False, False, False, True]
