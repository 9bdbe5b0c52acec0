# SPDX-License-Identifier: GPL-3.0-or-later
"""Bottom-level BVHs: which meshes keep the order of their triangles, and shadow rays compared with a reference."""

from itertools import pairwise

import numpy as np
import pytest

from ism_addon.gpu.accel import blas as blas_module
from ism_addon.gpu.accel.blas import BLAS, SORT_ALL_BELOW, DeferredBLAS, build_blas
from ism_addon.gpu.accel.bvh import quantize_boxes
from ism_addon.gpu.accel.small_blas import build_all_blas
from ism_addon.gpu.buffers.mesh_buffers import TRIANGLES_AT_A_TIME, MeshBuffers, TriangleOrder
from ism_addon.gpu.buffers.small_meshes import SMALL_MESH, small_mesh_groups
from ism_addon.gpu.buffers.small_meshes import TRIANGLES_AT_A_TIME as MAX_JOINED_TRIANGLES
from ism_addon.gpu.passes.upload.build_bvh import BuildBLAS
from tests.scenes.small import grid_triangles, mesh
from tests.support.rays import assert_agree, occluded, random_rays
from tests.support.small_scenes import light, make_scene, random_triangles


def wavy_grid(side: int, order: np.ndarray | None = None):
    """A wavy grid of 2 side² triangles, row after row, or with its quads in another order (side²,)."""
    line = np.linspace(-1.0, 1.0, side + 1)
    x, y = np.meshgrid(line, line, indexing="ij")
    points = np.stack([x, y, 0.2 * np.sin(7.0 * x) * np.sin(5.0 * y)], -1).reshape(-1, 3)
    triangles = grid_triangles(side + 1, side + 1).reshape(-1, 2, 3)
    return mesh(points, (triangles if order is None else triangles[order]).reshape(-1, 3))


#: Quads along a grid's side, so that it has more than SORT_ALL_BELOW triangles.
LARGE_SIDE = 261


def test_a_large_coherent_mesh_keeps_its_order(device):
    grid = wavy_grid(LARGE_SIDE)
    assert len(grid.triangles) > SORT_ALL_BELOW
    assert_agree(device, make_scene([grid, random_triangles(50, seed=1)], light()), *random_rays(150))
    blas = BuildBLAS.cache[grid].blas
    assert blas.order is None
    assert blas.triangles_per_leaf * len(np.unique(blas.leaf_starts)) >= len(grid.triangles)


def test_a_large_shuffled_mesh_is_sorted(device):
    shuffled = wavy_grid(LARGE_SIDE, np.random.default_rng(0).permutation(LARGE_SIDE**2))
    blas = build_blas(shuffled)
    assert np.array_equal(np.sort(blas.order), np.arange(len(shuffled.triangles)))
    assert_agree(device, make_scene([shuffled], light()), *random_rays(100))


def test_boxes_of_runs_are_right_wherever_a_portion_ends():
    """Two meshes share a portion, and no run ends where a portion does. Each box bounds the triangles of its run."""
    grid = wavy_grid(LARGE_SIDE)
    meshes = (random_triangles(5), grid)
    blases = tuple(map(build_blas, meshes))
    order = TriangleOrder(meshes, blases)
    list(order.map_portions(lambda ranges: [range_.positions() for range_ in ranges], with_vertices=True))
    deferred, quanta = blases[1], blases[1].quantization.quantize(grid.positions)
    assert isinstance(deferred, DeferredBLAS)
    assert (TRIANGLES_AT_A_TIME - 5) % deferred.run != 0 and len(grid.triangles) % deferred.run != 0
    corners = quanta[:, grid.triangles]
    for index, first in enumerate(range(0, len(grid.triangles), deferred.run)):
        run_corners = corners[:, first : first + deferred.run].reshape(3, -1, 1)
        assert np.array_equal(
            deferred.boxes[..., [index]], quantize_boxes(np.stack([run_corners.min(1), run_corners.max(1)]))
        )


def test_uploading_runs_starts_to_build_their_bvh(device):
    """It is built beside the pass that draws them, before it is used."""
    deferred = build_blas(grid := wavy_grid(LARGE_SIDE))
    MeshBuffers(device, (grid,), in_blas_order=True).add((0,), {0: deferred})
    assert deferred.future.result(timeout=60.0) is deferred.blas


def test_a_bvh_of_runs_that_failed_is_built_again(monkeypatch, device):
    """For example if memory was short for a while: later pictures show the mesh."""
    deferred = build_blas(grid := wavy_grid(LARGE_SIDE))
    with monkeypatch.context() as patch:
        patch.setattr(blas_module, "blas_of_runs", raise_memory_error)
        MeshBuffers(device, (grid,), in_blas_order=True).add((0,), {0: deferred})
        with pytest.raises(MemoryError):
            _ = deferred.blas
    assert deferred.blas.leaves > 0


def raise_memory_error(*_arguments):
    raise MemoryError


def test_runs_whose_bvh_is_built_keep_no_boxes_and_can_be_uploaded_again(device):
    """They are uploaded again when another mesh of the scene has changed."""
    grid = wavy_grid(LARGE_SIDE)
    scene, (starts, ends) = make_scene([grid], light()), random_rays(150)
    before = occluded(device, scene, starts, ends)
    assert BuildBLAS.cache[grid].boxes.size == 0
    more = make_scene([random_triangles(3, size=1e-3), grid], light())
    assert np.array_equal(occluded(device, more, starts, ends), before)


def is_same(one: BLAS, other: BLAS) -> bool:
    return one.triangles_per_leaf == other.triangles_per_leaf and all(
        np.array_equal(getattr(one, name), getattr(other, name)) for name in ("bounds", "nodes", "leaf_starts", "order")
    )


def test_blases_of_small_meshes_are_the_same_built_alone_and_together():
    """All shapes of small BVHs, several meshes of a shape with different counts, and large meshes between them."""
    counts = [*range(1, 70), 255, 256, 257, 1000, SMALL_MESH, SMALL_MESH + 1, 5000, *range(69, 0, -1)]
    meshes = [random_triangles(count, seed=seed) for seed, count in enumerate(counts)]
    together = build_all_blas(meshes)
    assert all(is_same(blas, build_blas(mesh)) for blas, mesh in zip(together, meshes, strict=True))


@pytest.mark.parametrize(
    "counts", [[], [1], [SMALL_MESH, SMALL_MESH + 1, 1, 2], [1, 9 * SMALL_MESH, 2], [SMALL_MESH] * 40], ids=str
)
def test_consecutive_small_meshes_are_grouped_and_others_are_alone(counts):
    groups = small_mesh_groups(counts)
    assert [index for group in groups for index in range(len(counts))[group]] == list(range(len(counts)))
    sizes = [counts[group] for group in groups]
    assert all(len(group) == 1 or (max(group) <= SMALL_MESH and sum(group) <= MAX_JOINED_TRIANGLES) for group in sizes)
    joinable = [
        max(one + other) <= SMALL_MESH and sum(one + other[:1]) <= MAX_JOINED_TRIANGLES
        for one, other in pairwise(sizes)
    ]
    assert not any(joinable), "consecutive groups that could be one are not"


def test_small_meshes_beside_a_large_one_cast_shadows(device):
    """The top-level BVH has boxes of meshes of several sizes, and rays hit all of them."""
    counts = (1, 3, 12, 30, 100, SMALL_MESH + 500)
    meshes = [random_triangles(count, size=0.5 if count < 50 else 0.1, seed=count) for count in counts]
    assert_agree(device, make_scene(meshes, light()), *random_rays(1000))


@pytest.mark.parametrize("count", [5, 6, 17, 24, 65, 96, 1030, 4200])
def test_leaves_are_filled(count):
    """Also for counts just above four times a power of four: leaves of four or fewer would hold hardly one each."""
    blas = build_blas(random_triangles(count))
    assert blas.triangles_per_leaf <= 6
    assert blas.leaves == 1 or 1.5 * blas.leaves <= count
