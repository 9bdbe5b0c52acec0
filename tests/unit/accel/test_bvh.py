# SPDX-License-Identifier: GPL-3.0-or-later
"""Trees of boxes: each box in one leaf, each parent around its children, as many boxes as may be."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ism_addon.gpu.accel.bvh import (
    BOX_SLACK,
    BVH,
    EMPTY_BOX,
    GRID_EXTENT,
    QUANTA_PER_PLANE,
    build,
    node_boxes,
    packed,
    packed_nodes_over,
    quantize_boxes,
    scale_of,
)
from ism_addon.parallel import MIN_PARALLEL_SIZE


def boxes(count: int, seed: int = 0, size: float = 0.1) -> np.ndarray:
    """(2,3,N): low and high corners of random boxes."""
    random = np.random.default_rng(seed)
    middle = random.normal(size=(count, 3)).astype(np.float32).T
    half = (size * random.random((count, 3))).astype(np.float32).T
    return np.stack([middle - half, middle + half])


def on_grid(found: np.ndarray) -> np.ndarray:
    """Boxes (2,3,N) in planes."""
    return quantize_boxes(found * scale_of(np.abs(found).max((0, 2)))[:, None])


def check(tree: BVH, given: np.ndarray, max_per_leaf: int) -> None:
    """All that a ray relies on, of a tree over boxes (2,3,N)."""
    (low, high), leaves = given.transpose(0, 2, 1), tree.leaves
    count, nodes = len(low), tree.nodes.transpose(2, 0, 1)
    assert leaves == 4 ** round(np.log(leaves) / np.log(4))
    assert tree.boxes_per_leaf * leaves == len(tree.order)
    assert 1 <= tree.boxes_per_leaf <= max_per_leaf
    assert (np.bincount(tree.order, minlength=count)[:count] == 1).all(), "every box is in one leaf once"
    nothing = np.tile(EMPTY_BOX[..., 0], (len(nodes), 1, 1))
    nowhere = (nodes == nothing).all((1, 2))
    assert (nodes[~nowhere, 0] < nodes[~nowhere, 1]).all()
    assert nowhere[0]
    assert not nowhere[1]
    for leaf, row in enumerate(tree.order.reshape(leaves, -1)):
        node, real = nodes[leaves + leaf], row[row < count]
        assert nowhere[leaves + leaf] == (not len(real))
        if len(real):
            assert np.array_equal(node, [low[real].min(0), high[real].max(0)])
    children = nodes[2:].reshape(leaves - 1, 2, 2, 3)
    assert np.array_equal(nodes[1:leaves, 0], children[:, :, 0].min(1))
    assert np.array_equal(nodes[1:leaves, 1], children[:, :, 1].max(1))
    assert np.array_equal(nodes[1], [low.min(0), high.max(0)])
    check_packed(tree)


def check_packed(tree: BVH) -> None:
    """As bytes, boxes are around those they stand for, and less than a unit wider; or hold nothing."""
    rows, nodes = packed(tree.nodes), tree.nodes.transpose(2, 0, 1).astype(int)
    assert rows.dtype.itemsize == 32
    assert len(rows) == tree.leaves // 2
    levels = np.arange(1, len(rows))
    read = levels[np.log2(levels).astype(int) % 2 == 0]
    row, inside = rows[read], nodes[4 : 4 * len(rows)].reshape(-1, 4, 2, 3)[read - 1]
    unit = 2 ** (row["exponent"][:, None].astype(int) >> np.array([0, 4, 8]) & 15)[:, None]
    low, high = (row["origin"][:, None] + row[side].swapaxes(1, 2) * unit for side in ("child_min", "child_max"))
    nothing = inside[:, :, 0, 0] > inside[:, :, 1, 0]
    assert (low > high)[nothing].all()
    for packed_too_far in (inside[:, :, 0] - low, high - inside[:, :, 1]):
        assert (packed_too_far >= 0)[~nothing].all()
        assert (packed_too_far < unit)[~nothing].all()
    around = nodes[read]
    extent = (around[:, 1] - around[:, 0])[:, None]
    assert (unit <= np.maximum(1, extent / 127.5))[~nothing.all(1)].all()


@pytest.mark.parametrize("size", [0.0, 1.0, 1e3, GRID_EXTENT])
def test_planes_leave_slack_around_a_box(size):
    """And no more than it and a plane."""
    random = np.random.default_rng(0)
    found = np.sort(random.uniform(-size, size, (2, 3, 1000)).astype(np.float32), 0)
    low, high = quantize_boxes(found).astype(np.float64) * QUANTA_PER_PLANE
    for distance in (found[0] - low, high - found[1]):
        assert (distance >= BOX_SLACK - 2.0).all()
        assert (distance <= BOX_SLACK + QUANTA_PER_PLANE + 2.0).all()


@pytest.mark.parametrize("max_per_leaf", [1, 4])
@pytest.mark.parametrize(
    "count", [1, 2, 3, 4, 5, 1000, MIN_PARALLEL_SIZE - 1, MIN_PARALLEL_SIZE + 1, 3 * MIN_PARALLEL_SIZE]
)
def test_trees_of_all_sizes(count, max_per_leaf):
    given = on_grid(boxes(count))
    check(build(given, max_per_leaf), given, max_per_leaf)


@pytest.mark.parametrize("leaves", [16, 4**8])
def test_rows_in_portions_are_those_of_all_nodes_at_once(leaves):
    """With leaves that hold nothing: some, and all below a node."""
    given = on_grid(boxes(leaves))
    members = np.random.default_rng(0).integers(0, leaves + leaves // 2, leaves)
    members = np.minimum(members, leaves)
    members[4:12] = leaves
    rows, nodes = packed_nodes_over(given, members)
    expected = node_boxes(given, members)
    assert np.array_equal(rows, packed(expected))
    assert np.array_equal(nodes, expected[..., : leaves // 2])


@settings(deadline=None, derandomize=True, max_examples=60)
@given(
    st.integers(1, 300),
    st.integers(1, 9),
    st.integers(0, 2**32 - 1),
    st.sampled_from([0.0, 1e-6, 1.0, 1e6]),
    st.lists(st.sampled_from([0.0, 1e-20, 1.0, 1e12]), min_size=3, max_size=3),
)
def test_any_boxes(count, max_per_leaf, seed, size, scale):
    """Points, huge ones, all in one plane, on one line, or in one place."""
    given = on_grid(boxes(count, seed, size) * np.array(scale, np.float32)[:, None])
    check(build(given, max_per_leaf), given, max_per_leaf)


def test_the_slack_is_more_than_rays_err():
    """Where a ray passes a plane, in the shader's order of float32, as far off as that moves the plane."""
    random = np.random.default_rng(0)
    count = 1_000_000
    origin = random.uniform(-2.0 * GRID_EXTENT, 2.0 * GRID_EXTENT, count).astype(np.float32)
    origin[::2] /= np.float32(2.0) ** random.integers(0, 24, count // 2)
    inverse_ray = (random.choice([-1.0, 1.0], count) / random.uniform(1.0, GRID_EXTENT, count)).astype(np.float32)
    power, byte = random.integers(0, 9, count), random.integers(0, 256, count)
    begin = random.integers(-(2**15) + 128, 2**15, count) * QUANTA_PER_PLANE
    unit = (QUANTA_PER_PLANE << power).astype(np.float32)
    passes = byte.astype(np.float32) * (unit * inverse_ray) + (begin.astype(np.float32) - origin) * inverse_ray
    assert passes.dtype == np.float32
    plane = begin + byte * unit.astype(np.float64)
    near = np.abs(plane) <= GRID_EXTENT + QUANTA_PER_PLANE
    off = np.abs(passes / inverse_ray.astype(np.float64) + origin.astype(np.float64) - plane)[near]
    assert near.mean() > 0.3
    assert BOX_SLACK / 8.0 < off.max() < BOX_SLACK / 2.0


def test_the_outermost_boxes_end_in_the_last_planes():
    """A room: its walls take all of a byte, and coordinates with the slack all of the grid."""
    room = np.repeat(np.float32([-5.1, 5.1])[:, None, None], 3, 1)
    row = packed(build(on_grid(np.repeat(room, 5, 2)), 1).nodes)[1]
    assert row["origin"].tolist() == [-255 * 128] * 3
    assert row["exponent"] == 8 * (1 + 16 + 256)
    assert row["child_min"].max(1).tolist() == [255] * 3 and row["child_min"].min(1).tolist() == [0] * 3


def test_the_same_boxes_make_the_same_tree():
    given = on_grid(boxes(2 * MIN_PARALLEL_SIZE))
    one, two = build(given, 4), build(given.copy(), 4)
    assert np.array_equal(one.order, two.order)
    assert np.array_equal(one.nodes, two.nodes)


def area(nodes: np.ndarray) -> np.ndarray:
    """Half the surface of boxes (2,3,N): in proportion to it rays meet them."""
    x, y, z = np.subtract(*nodes[::-1], dtype=float)
    return x * y + y * z + z * x


@pytest.mark.parametrize("stretch", [(1, 1, 1), (1, 50, 1), (1, 1, 50)])
def test_leaves_are_small(stretch):
    """Cut along the longest side, 4096 boxes spread evenly end up in leaves as compact as can be, however they lie."""
    random, planes = np.random.default_rng(1), 600.0
    middle = (planes * random.random((4096, 3)) * stretch).astype(np.int16).T
    tree = build(np.stack([middle, middle]), 4)
    volume = planes**3 * np.prod(np.array(stretch, float)) / tree.leaves
    assert np.median(area(tree.nodes[..., tree.leaves :])) < 3.0 * volume ** (2.0 / 3.0)


def test_halves_of_a_large_tree_are_cut_like_a_small_one():
    """Two threads split what is larger than MIN_PARALLEL_SIZE: its leaves are no worse than what one thread makes."""
    small, large = (build(on_grid(boxes(count, size=0.0)), 4) for count in (MIN_PARALLEL_SIZE, 8 * MIN_PARALLEL_SIZE))
    of_small, of_large = (np.median(area(tree.nodes[..., tree.leaves :])) for tree in (small, large))
    assert of_large < of_small
