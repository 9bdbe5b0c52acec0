# SPDX-License-Identifier: GPL-3.0-or-later
"""Which triangles of a mesh are sorted, and which stay where they are; rays find the same through either tree."""

import numpy as np

from ism_addon.gpu import mesh_tree as mesh_trees
from ism_addon.gpu.mesh_tree import FEW, mesh_tree
from ism_addon.gpu.passes.trees import MeshTrees

from .rays import compare, occluded, rays
from .scenes.small import grid_triangles, mesh
from .studio import light, rubble, stage


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
    tree = mesh_tree(sheet)
    assert len(sheet.triangles) > FEW
    assert tree.order is None
    assert tree.per_leaf * len(np.unique(tree.starts)) >= len(sheet.triangles)
    compare(device, stage([sheet, rubble(50, seed=1)], light()), *rays(150))


def test_a_large_mesh_in_no_order_is_sorted(device):
    shuffled = bumps(MANY, np.random.default_rng(0).permutation(MANY**2))
    tree = mesh_tree(shuffled)
    assert np.array_equal(np.sort(tree.order), np.arange(len(shuffled.triangles)))
    compare(device, stage([shuffled], light()), *rays(100))


def test_runs_of_runs_are_taken_together(device, monkeypatch):
    """As with ten million triangles: what is sorted is few, and rays find the same."""
    monkeypatch.setattr(mesh_trees, "MANY", 64)
    sheet = bumps(MANY)
    scene, (starts, ends) = stage([sheet], light()), rays(200)
    grouped, tree = occluded(device, scene, starts, ends), MeshTrees.kept[sheet]
    neighbours = np.diff(tree.starts.astype(int)) == tree.per_leaf
    assert neighbours.sum() > 0.7 * len(np.unique(tree.starts)), "runs of four runs"
    monkeypatch.undo()
    MeshTrees.kept.clear()
    assert np.array_equal(occluded(device, scene, starts, ends), grouped)
    neighbours = np.diff(MeshTrees.kept[sheet].starts.astype(int)) == tree.per_leaf
    assert neighbours.sum() < 0.7 * len(np.unique(tree.starts))
