# SPDX-License-Identifier: GPL-3.0-or-later
"""BVHs over any number of boxes: each box is in one leaf, and each node bounds its children."""

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
    centre = random.normal(size=(count, 3)).astype(np.float32).T
    half = (size * random.random((count, 3))).astype(np.float32).T
    return np.stack([centre - half, centre + half])


def on_grid(unscaled: np.ndarray) -> np.ndarray:
    """Boxes (2,3,N) in planes of the grid of a BVH over them."""
    return quantize_boxes(unscaled * scale_of(np.abs(unscaled).max((0, 2)))[:, None])


def check_bvh(bvh: BVH, planes: np.ndarray, max_per_leaf: int) -> None:
    """Assert all properties that rays rely on, of a BVH over boxes (2,3,N) in planes."""
    (low, high), leaves = planes.transpose(0, 2, 1), bvh.leaves
    count, nodes = len(low), bvh.nodes.transpose(2, 0, 1)
    assert leaves == 4 ** round(np.log(leaves) / np.log(4))
    assert bvh.boxes_per_leaf * leaves == len(bvh.order)
    assert 1 <= bvh.boxes_per_leaf <= max_per_leaf
    assert (np.bincount(bvh.order, minlength=count)[:count] == 1).all(), "every box is in one leaf once"
    empty = np.tile(EMPTY_BOX[..., 0], (len(nodes), 1, 1))
    is_empty = (nodes == empty).all((1, 2))
    assert (nodes[~is_empty, 0] < nodes[~is_empty, 1]).all()
    assert is_empty[0]
    assert not is_empty[1]
    for leaf, members in enumerate(bvh.order.reshape(leaves, -1)):
        node, indices = nodes[leaves + leaf], members[members < count]
        assert is_empty[leaves + leaf] == (not len(indices))
        if len(indices):
            assert np.array_equal(node, [low[indices].min(0), high[indices].max(0)])
    children = nodes[2:].reshape(leaves - 1, 2, 2, 3)
    assert np.array_equal(nodes[1:leaves, 0], children[:, :, 0].min(1))
    assert np.array_equal(nodes[1:leaves, 1], children[:, :, 1].max(1))
    assert np.array_equal(nodes[1], [low.min(0), high.max(0)])
    check_packed_nodes(bvh)


def check_packed_nodes(bvh: BVH) -> None:
    """Assert that packed boxes contain the exact ones and exceed them by less than a unit, or are empty as they are."""
    rows, nodes = packed(bvh.nodes), bvh.nodes.transpose(2, 0, 1).astype(int)
    assert rows.dtype.itemsize == 32
    assert len(rows) == bvh.leaves // 2
    levels = np.arange(1, len(rows))
    parents = levels[np.log2(levels).astype(int) % 2 == 0]
    row, children = rows[parents], nodes[4 : 4 * len(rows)].reshape(-1, 4, 2, 3)[parents - 1]
    unit = 2 ** (row["exponent"][:, None].astype(int) >> np.array([0, 4, 8]) & 15)[:, None]
    low, high = (row["origin"][:, None] + row[side].swapaxes(1, 2) * unit for side in ("child_min", "child_max"))
    is_empty = children[:, :, 0, 0] > children[:, :, 1, 0]
    assert (low > high)[is_empty].all()
    for excess in (children[:, :, 0] - low, high - children[:, :, 1]):
        assert (excess >= 0)[~is_empty].all()
        assert (excess < unit)[~is_empty].all()
    bounds = nodes[parents]
    extent = (bounds[:, 1] - bounds[:, 0])[:, None]
    assert (unit <= np.maximum(1, extent / 127.5))[~is_empty.all(1)].all()


@pytest.mark.parametrize("size", [0.0, 1.0, 1e3, GRID_EXTENT])
def test_quantized_boxes_are_enlarged_by_the_slack(size):
    """And by no more than the slack and one plane."""
    random = np.random.default_rng(0)
    exact = np.sort(random.uniform(-size, size, (2, 3, 1000)).astype(np.float32), 0)
    low, high = quantize_boxes(exact).astype(np.float64) * QUANTA_PER_PLANE
    for distance in (exact[0] - low, high - exact[1]):
        assert (distance >= BOX_SLACK - 2.0).all()
        assert (distance <= BOX_SLACK + QUANTA_PER_PLANE + 2.0).all()


@pytest.mark.parametrize("max_per_leaf", [1, 4])
@pytest.mark.parametrize(
    "count", [1, 2, 3, 4, 5, 1000, MIN_PARALLEL_SIZE - 1, MIN_PARALLEL_SIZE + 1, 3 * MIN_PARALLEL_SIZE]
)
def test_bvhs_of_all_sizes(count, max_per_leaf):
    planes = on_grid(boxes(count))
    check_bvh(build(planes, max_per_leaf), planes, max_per_leaf)


@pytest.mark.parametrize("leaves", [16, 4**8])
def test_nodes_packed_in_portions_are_those_packed_at_once(leaves):
    """Some leaves are empty, also all below one node."""
    planes = on_grid(boxes(leaves))
    members = np.random.default_rng(0).integers(0, leaves + leaves // 2, leaves)
    members = np.minimum(members, leaves)
    members[4:12] = leaves
    packed_nodes, nodes = packed_nodes_over(planes, members)
    expected = node_boxes(planes, members)
    assert np.array_equal(packed_nodes, packed(expected))
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
    """Points, huge boxes, all in one plane, on one line, or at one point."""
    planes = on_grid(boxes(count, seed, size) * np.array(scale, np.float32)[:, None])
    check_bvh(build(planes, max_per_leaf), planes, max_per_leaf)


def test_the_slack_exceeds_the_rounding_error_of_rays():
    """Errors of intersections with a plane, as shifts of the plane. The order of float32 operations is the shader's."""
    random = np.random.default_rng(0)
    count = 1_000_000
    origin = random.uniform(-2.0 * GRID_EXTENT, 2.0 * GRID_EXTENT, count).astype(np.float32)
    origin[::2] /= np.float32(2.0) ** random.integers(0, 24, count // 2)
    inverse_ray = (random.choice([-1.0, 1.0], count) / random.uniform(1.0, GRID_EXTENT, count)).astype(np.float32)
    exponent, byte = random.integers(0, 9, count), random.integers(0, 256, count)
    node_origin = random.integers(-(2**15) + 128, 2**15, count) * QUANTA_PER_PLANE
    unit = (QUANTA_PER_PLANE << exponent).astype(np.float32)
    t = byte.astype(np.float32) * (unit * inverse_ray) + (node_origin.astype(np.float32) - origin) * inverse_ray
    assert t.dtype == np.float32
    plane = node_origin + byte * unit.astype(np.float64)
    is_on_grid = np.abs(plane) <= GRID_EXTENT + QUANTA_PER_PLANE
    error = np.abs(t / inverse_ray.astype(np.float64) + origin.astype(np.float64) - plane)[is_on_grid]
    assert is_on_grid.mean() > 0.3
    assert BOX_SLACK / 8.0 < error.max() < BOX_SLACK / 2.0


def test_the_outermost_boxes_end_on_the_last_planes():
    """Boxes of a room's walls use the whole range of a byte, and its bounds with the slack the whole grid."""
    room = np.repeat(np.float32([-5.1, 5.1])[:, None, None], 3, 1)
    node = packed(build(on_grid(np.repeat(room, 5, 2)), 1).nodes)[1]
    assert node["origin"].tolist() == [-255 * 128] * 3
    assert node["exponent"] == 8 * (1 + 16 + 256)
    assert node["child_min"].max(1).tolist() == [255] * 3 and node["child_min"].min(1).tolist() == [0] * 3


def test_the_same_boxes_give_the_same_bvh():
    planes = on_grid(boxes(2 * MIN_PARALLEL_SIZE))
    one, two = build(planes, 4), build(planes.copy(), 4)
    assert np.array_equal(one.order, two.order)
    assert np.array_equal(one.nodes, two.nodes)


def area(nodes: np.ndarray) -> np.ndarray:
    """Half the surface area of boxes (2,3,N): the number of rays that hit them is in proportion."""
    x, y, z = np.subtract(*nodes[::-1], dtype=float)
    return x * y + y * z + z * x


@pytest.mark.parametrize("stretch", [(1, 1, 1), (1, 50, 1), (1, 1, 50)])
def test_leaves_are_small(stretch):
    """Splits along the longest axis make compact leaves of 4096 uniformly distributed boxes, also of stretched ones."""
    random, planes = np.random.default_rng(1), 600.0
    centre = (planes * random.random((4096, 3)) * stretch).astype(np.int16).T
    bvh = build(np.stack([centre, centre]), 4)
    volume = planes**3 * np.prod(np.array(stretch, float)) / bvh.leaves
    assert np.median(area(bvh.nodes[..., bvh.leaves :])) < 3.0 * volume ** (2.0 / 3.0)


def test_halves_of_a_large_bvh_are_split_like_a_small_one():
    """Two threads split more than MIN_PARALLEL_SIZE boxes: the leaves are no larger than those made by one thread."""
    small, large = (build(on_grid(boxes(count, size=0.0)), 4) for count in (MIN_PARALLEL_SIZE, 8 * MIN_PARALLEL_SIZE))
    small_area, large_area = (np.median(area(bvh.nodes[..., bvh.leaves :])) for bvh in (small, large))
    assert large_area < small_area
