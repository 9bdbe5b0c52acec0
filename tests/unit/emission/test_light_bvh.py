# SPDX-License-Identifier: GPL-3.0-or-later
"""Light BVHs: sums and bounds of their nodes."""

import numpy as np
import pytest

from ism_addon.gpu.emission.light_bvh import (
    ELEMENT_AXES,
    MAX_PER_LEAF,
    MIN_LEAVES,
    LightBVH,
    median_leaves,
    normal_areas,
)

COUNTS = [17, 64, 65, 500]


@pytest.fixture(params=COUNTS)
def triangles(request):
    """(N,3,3) random triangles, far from the origin."""
    random = np.random.default_rng(request.param)
    return 100.0 + random.normal(size=(request.param, 1, 3)) + 0.1 * random.normal(size=(request.param, 3, 3))


def members(bvh: LightBVH, node: int, count: int) -> np.ndarray:
    """Indices of the triangles below a node."""
    first, last = node, node
    while first < bvh.leaves:
        first, last = 2 * first, 2 * last + 1
    rows = bvh.triangles.reshape(bvh.leaves, -1)[first - bvh.leaves : last - bvh.leaves + 1].ravel()
    return rows[rows < count]


def test_each_triangle_is_in_one_leaf(triangles):
    bvh, count = LightBVH.over(triangles), len(triangles)
    assert sorted(bvh.triangles[bvh.triangles < count]) == list(range(count))
    assert bvh.leaves >= MIN_LEAVES and len(bvh.triangles) // bvh.leaves <= MAX_PER_LEAF


@pytest.mark.parametrize("textured", [False, True])
def test_nodes_have_the_moments_of_their_triangles(triangles, textured):
    """Against sums over many points of the triangles, weighted by their relative luminance."""
    random = np.random.default_rng(1)
    colors = np.exp(random.normal(size=(len(triangles), 4))) if textured else np.ones((len(triangles), 4))
    bvh, normals = LightBVH.over(triangles, colors if textured else None), normal_areas(triangles)
    normals = normals * colors[:, 3:]
    areas = np.linalg.norm(normals, axis=1)
    assert (bvh.color is not None) == textured
    for node in (1, 2, 3, 7, bvh.leaves, 2 * bvh.leaves - 1):
        own = members(bvh, node, len(triangles))
        if not len(own):
            assert bvh.area[node] == 0.0
            continue
        area, corners = areas[own].sum(), triangles[own]
        centre = (corners.mean(1) * areas[own, None]).sum(0) / area
        assert bvh.area[node] == pytest.approx(area, rel=1e-5)
        if textured:
            assert np.allclose(bvh.color[node], (colors[own, :3] * areas[own, None]).sum(0) / area)
        assert np.allclose(bvh.centre[node], centre, rtol=0.0, atol=1e-5)
        assert np.allclose(bvh.normal[node], normals[own].sum(0), atol=1e-5 * area)
        outer = np.einsum("ni,nj->ij", normals[own], normals[own] / areas[own, None])  # the second are unit vectors
        assert np.allclose(bvh.normal_normal[node], outer[*ELEMENT_AXES], atol=1e-5 * area)
        offsets = corners.mean(1) - centre
        mixed = np.einsum("ni,nj->ij", normals[own], offsets).ravel()
        assert np.allclose(bvh.normal_position[node], mixed, atol=1e-5 * area)
        # A quadrature of degree 2 is exact for second moments.
        points = np.einsum("kc,nci->nki", np.eye(3) * 0.5 + 1.0 / 6.0, corners) - centre
        second = np.einsum("nci,ncj,n->ij", points, points, areas[own] / 3.0)
        assert np.allclose(bvh.position_position[node], second[*ELEMENT_AXES], atol=2e-5 * area)


def test_nodes_bound_their_triangles(triangles):
    bvh, normals = LightBVH.over(triangles), normal_areas(triangles)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    for node in range(1, 2 * bvh.leaves):
        own = members(bvh, node, len(triangles))
        if len(own):
            assert np.linalg.norm(triangles[own] - bvh.centre[node], axis=2).max() <= bvh.radius[node] * (1 + 1e-5)
            axis = bvh.normal[node] / np.linalg.norm(bvh.normal[node])
            angle = np.arccos(np.clip(normals[own] @ axis, -1.0, 1.0)).max()
            assert bvh.normal_sine[node] == pytest.approx(np.sin(angle) if angle < np.pi / 2.0 else 2.0, abs=2e-3)


def test_a_tree_separates_the_sides_of_a_box():
    """By normals, though positions alternate."""
    random = np.random.default_rng(3)
    points = np.concatenate([random.uniform(-0.1, 0.1, (64, 3)), random.choice([-1.0, 1.0], (64, 1))], 1)
    leaves = median_leaves(points, 4)
    sides = points[leaves[leaves < 64].reshape(-1), 3]
    assert len(leaves) == 16
    assert (np.diff(sides) != 0.0).sum() < 16, "few leaves are mixed"


@pytest.mark.parametrize("count", [1, 5, 16, 100])
def test_leaves_hold_all_points_once(count):
    points = np.random.default_rng(count).normal(size=(count, 3))
    leaves = median_leaves(points, 3)
    assert sorted(leaves[leaves < count]) == list(range(count))
    assert leaves.shape[1] <= 3
