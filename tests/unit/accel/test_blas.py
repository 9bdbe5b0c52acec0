# SPDX-License-Identifier: GPL-3.0-or-later
"""Which triangles of a mesh are sorted, and which stay where they are; rays find the same through either tree."""

from itertools import pairwise

import numpy as np
import pytest

from ism_addon.gpu.accel import blas as mesh_tree_module
from ism_addon.gpu.accel.blas import BLAS, SORT_ALL_BELOW, DeferredBLAS, build_blas
from ism_addon.gpu.accel.bvh import quantize_boxes
from ism_addon.gpu.accel.small_blas import build_all_blas
from ism_addon.gpu.buffers.mesh_buffers import TRIANGLES_AT_A_TIME, MeshBuffers, TriangleOrder
from ism_addon.gpu.buffers.small_meshes import SMALL_MESH, small_mesh_groups
from ism_addon.gpu.buffers.small_meshes import TRIANGLES_AT_A_TIME as TOGETHER
from ism_addon.gpu.passes.upload.build_bvh import BuildBLAS
from tests.scenes.small import grid_triangles, mesh
from tests.support.rays import assert_agree, occluded, random_rays
from tests.support.small_scenes import light, make_scene, random_triangles


def bumps(side: int, order: np.ndarray | None = None):
    """A sheet of 2 side² triangles, row after row, or in another order (side²,) of its quads."""
    line = np.linspace(-1.0, 1.0, side + 1)
    x, y = np.meshgrid(line, line, indexing="ij")
    points = np.stack([x, y, 0.2 * np.sin(7.0 * x) * np.sin(5.0 * y)], -1).reshape(-1, 3)
    triangles = grid_triangles(side + 1, side + 1).reshape(-1, 2, 3)
    return mesh(points, (triangles if order is None else triangles[order]).reshape(-1, 3))


#: Quads along a sheet's side, so that it is none of the few.
MANY = 261


def test_a_large_mesh_whose_neighbours_lie_together_stays_in_its_order(device):
    sheet = bumps(MANY)
    assert len(sheet.triangles) > SORT_ALL_BELOW
    assert_agree(device, make_scene([sheet, random_triangles(50, seed=1)], light()), *random_rays(150))
    tree = BuildBLAS.kept[sheet].blas
    assert tree.order is None
    assert tree.triangles_per_leaf * len(np.unique(tree.leaf_starts)) >= len(sheet.triangles)


def test_a_large_mesh_in_no_order_is_sorted(device):
    shuffled = bumps(MANY, np.random.default_rng(0).permutation(MANY**2))
    tree = build_blas(shuffled)
    assert np.array_equal(np.sort(tree.order), np.arange(len(shuffled.triangles)))
    assert_agree(device, make_scene([shuffled], light()), *random_rays(100))


def test_runs_are_bounded_wherever_portions_of_them_end():
    """Two meshes share a portion, and no run ends with one: each box is around its triangles."""
    sheet = bumps(MANY)
    meshes = (random_triangles(5), sheet)
    trees = tuple(map(build_blas, meshes))
    order = TriangleOrder(meshes, trees)
    list(order.map_portions(lambda pieces: [piece.positions() for piece in pieces], with_vertices=True))
    runs, steps = trees[1], trees[1].quantization.quantize(sheet.positions)
    assert isinstance(runs, DeferredBLAS)
    assert (TRIANGLES_AT_A_TIME - 5) % runs.run != 0 and len(sheet.triangles) % runs.run != 0
    corners = steps[:, sheet.triangles]
    for number, first in enumerate(range(0, len(sheet.triangles), runs.run)):
        of_run = corners[:, first : first + runs.run].reshape(3, -1, 1)
        assert np.array_equal(runs.boxes[..., [number]], quantize_boxes(np.stack([of_run.min(1), of_run.max(1)])))


def test_the_tree_of_runs_is_begun_when_they_are_uploaded(device):
    """It need not be asked for: it is made beside the pass that draws them."""
    runs = build_blas(sheet := bumps(MANY))
    MeshBuffers(device, (sheet,), in_blas_order=True).add((0,), {0: runs})
    assert runs.future.result(timeout=60.0) is runs.blas


def test_a_tree_of_runs_that_has_failed_is_tried_again(monkeypatch, device):
    """As where memory was short for a while: the mesh is not lost for all pictures to come."""
    runs = build_blas(sheet := bumps(MANY))
    with monkeypatch.context() as short:
        short.setattr(mesh_tree_module, "blas_of_runs", no_memory)
        MeshBuffers(device, (sheet,), in_blas_order=True).add((0,), {0: runs})
        with pytest.raises(MemoryError):
            _ = runs.blas
    assert runs.blas.leaves > 0


def no_memory(*_arguments):
    raise MemoryError


def test_runs_that_have_their_tree_keep_no_boxes_and_are_uploaded_again(device):
    """As when another mesh of the scene has changed."""
    sheet = bumps(MANY)
    scene, (starts, ends) = make_scene([sheet], light()), random_rays(150)
    before = occluded(device, scene, starts, ends)
    assert BuildBLAS.kept[sheet].boxes.size == 0
    more = make_scene([random_triangles(3, size=1e-3), sheet], light())
    assert np.array_equal(occluded(device, more, starts, ends), before)


def same_tree(one: BLAS, other: BLAS) -> bool:
    return one.triangles_per_leaf == other.triangles_per_leaf and all(
        np.array_equal(getattr(one, name), getattr(other, name)) for name in ("bounds", "nodes", "leaf_starts", "order")
    )


def test_the_trees_of_small_meshes_are_the_same_alone_and_together():
    """Of all small shapes of trees, several of a shape with different counts, and large ones between them."""
    counts = [*range(1, 70), 255, 256, 257, 1000, SMALL_MESH, SMALL_MESH + 1, 5000, *range(69, 0, -1)]
    meshes = [random_triangles(count, seed=number) for number, count in enumerate(counts)]
    together = build_all_blas(meshes)
    assert all(same_tree(tree, build_blas(mesh)) for tree, mesh in zip(together, meshes, strict=True))


@pytest.mark.parametrize(
    "counts", [[], [1], [SMALL_MESH, SMALL_MESH + 1, 1, 2], [1, 9 * SMALL_MESH, 2], [SMALL_MESH] * 40], ids=str
)
def test_small_neighbours_are_in_groups_and_others_alone(counts):
    groups = small_mesh_groups(counts)
    assert [number for group in groups for number in range(len(counts))[group]] == list(range(len(counts)))
    sizes = [counts[group] for group in groups]
    assert all(len(some) == 1 or (max(some) <= SMALL_MESH and sum(some) <= TOGETHER) for some in sizes)
    apart = [max(one + other) <= SMALL_MESH and sum(one + other[:1]) <= TOGETHER for one, other in pairwise(sizes)]
    assert not any(apart), "neighbours that might be in one group are not"


def test_small_meshes_with_a_large_one_cast_their_shadows(device):
    """Rays find all of them where the tree over the instances has boxes of meshes of several sizes."""
    counts = (1, 3, 12, 30, 100, SMALL_MESH + 500)
    meshes = [random_triangles(count, size=0.5 if count < 50 else 0.1, seed=count) for count in counts]
    assert_agree(device, make_scene(meshes, light()), *random_rays(1000))


@pytest.mark.parametrize("count", [5, 6, 17, 24, 65, 96, 1030, 4200])
def test_leaves_are_filled(count):
    """Also of meshes of a few triangles more than a power of four, times four: leaves would hold hardly one each."""
    tree = build_blas(random_triangles(count))
    assert tree.triangles_per_leaf <= 6
    assert tree.leaves == 1 or 1.5 * tree.leaves <= count
