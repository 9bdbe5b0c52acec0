# SPDX-License-Identifier: GPL-3.0-or-later
"""What shadow rays look through: a tree over each mesh's triangles, and one over the instances that cast shadows.

Two levels, as in every ray tracer that moves things: a mesh keeps its tree wherever its instances go.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import moderngl
import numpy as np

from ...scene import Change, Mesh
from ..buffers import centre_of, joined
from ..context import Device
from ..layout import CASTER, WIDTH, upload_array
from ..tree import NOWHERE, Tree, build
from . import Frame, Pass

#: Most triangles in a leaf: fewer make larger trees, more are tested in vain.
TRIANGLES_PER_LEAF = 4

#: An axis that an instance squeezes to less than this part of its longest is kept as long: flat things have two sides.
FLATTEST = 1e-6


#: Boxes of a mesh by which its instances are bounded; a power of two.
PARTS = 32


@dataclass(frozen=True)
class MeshTree:
    """A mesh's tree, about the middle of its box, and its triangles leaf by leaf."""

    tree: Tree
    triangles: np.ndarray  # (leaves * per_leaf, 3, 4) float32: a corner and its two edges; w: the triangle's number

    @property
    def parts(self) -> np.ndarray:
        """(PARTS,2,3): boxes around all of the mesh, closer than one box when it is turned."""
        level = min(PARTS, self.tree.leaves)
        boxes = self.tree.nodes[level : 2 * level]
        boxes = boxes[boxes[:, 0, 0] < NOWHERE]
        return boxes[np.arange(PARTS) % len(boxes)]


def mesh_tree(mesh: Mesh) -> MeshTree:
    """The tree of a mesh that has triangles."""
    corners = (mesh.positions - centre_of(mesh.positions)).astype(np.float32)[mesh.triangles]
    tree = build(corners.min(1), corners.max(1), TRIANGLES_PER_LEAF)
    sorted_corners = corners[tree.order]
    triangles = np.zeros((len(tree.order), 3, 4), np.float32)
    triangles[:, 0, :3] = sorted_corners[:, 0]
    triangles[:, 1:, :3] = sorted_corners[:, 1:] - sorted_corners[:, :1]
    triangles[:, 0, 3] = tree.order
    return MeshTree(tree, triangles)


class MeshTrees(Pass):
    """A tree for each mesh; a mesh that did not change keeps its own."""

    makes = ("mesh_trees",)
    depends_on = (Change.MESHES,)

    def __init__(self, device: Device):
        super().__init__(device)
        self.kept: WeakKeyDictionary[Mesh, MeshTree] = WeakKeyDictionary()

    def needed(self, frame: Frame) -> bool:
        return frame.traces

    def draw(self, frame: Frame) -> None:
        meshes = frame.scene.meshes
        new = [mesh for mesh in meshes if mesh not in self.kept]
        with ThreadPoolExecutor() as cores:
            self.kept.update(zip(new, cores.map(mesh_tree, new), strict=True))
        frame.tables["mesh_trees"] = [self.kept[mesh] for mesh in meshes]


class MeshTextures:
    """The trees of all meshes one behind the other, and before them room for the tree over the instances."""

    def __init__(self, gl: moderngl.Context, trees: list[MeshTree], leaves: int):
        self.lines = -(-3 * leaves // WIDTH)
        sizes = [tree.tree.leaves for tree in trees]
        room = np.zeros((self.lines * WIDTH, 4), np.float32)
        pairs = [tree.tree.pairs.reshape(-1, 4) for tree in trees]
        triangles = joined([tree.triangles.reshape(-1, 4) for tree in trees], (0, 4), "f4")
        # Texel 3 k is node k's: room is whole lines, which need not be whole nodes, so the meshes' count on from there.
        self.first_nodes = np.cumsum([-(-len(room) // 3)] + sizes)[:-1]
        gap = np.zeros((-len(room) % 3, 4), np.float32)
        self.nodes = upload_array(gl, np.concatenate([room, gap, *pairs]), "f4")
        self.triangles = upload_array(gl, triangles, "f4")
        self.first_triangles = np.cumsum([0] + [len(tree.triangles) for tree in trees])[:-1]
        self.bytes = triangles.nbytes + 48 * sum(sizes)

    def write_instances(self, pairs: np.ndarray) -> None:
        """The tree over the instances: pairs (leaves, 12)."""
        texels = np.zeros((self.lines * WIDTH, 4), np.float32)
        texels[: 3 * len(pairs)] = pairs.reshape(-1, 4)
        self.nodes.write(texels, viewport=(0, 0, WIDTH, self.lines))


class InstanceTree(Pass):
    """The tree over the instances that cast shadows; moving one uploads nothing of the meshes."""

    reads = ("mesh_trees", "geometry", "placement")
    makes = ("casters",)
    depends_on = (Change.INSTANCES,)

    def __init__(self, device: Device):
        super().__init__(device)
        self.trees: list[MeshTree] | None = None
        self.textures: MeshTextures | None = None

    def needed(self, frame: Frame) -> bool:
        return frame.traces

    def draw(self, frame: Frame) -> None:
        trees, instances = frame.tables["mesh_trees"], frame.scene.instances
        chosen = np.flatnonzero(instances.casts_shadow)
        mesh = instances.mesh[chosen]
        linear = instances.world_from_object[chosen, :3, :3]
        centres = frame.tables["geometry"].centres[mesh]
        offsets = instances.world_from_object[chosen, :3, 3] - frame.anchor + np.einsum("nij,nj->ni", linear, centres)
        parts = np.array([tree.parts for tree in trees])[mesh]
        tree = build(*boxes_around(linear, offsets, parts), 1)
        if self.textures is None or self.trees is not trees or 3 * tree.leaves > self.textures.lines * WIDTH:
            self.trees, self.textures = trees, MeshTextures(self.device.gl, trees, tree.leaves)
            frame.counts["bytes_uploaded"] += self.textures.bytes
        self.textures.write_instances(tree.pairs)
        table = np.zeros(len(chosen), CASTER.dtype)
        inverse = inverse_of(linear)
        rows = np.concatenate([inverse, -np.einsum("nij,nj->ni", inverse, offsets)[:, :, None]], 2)
        for k in range(3):
            table[f"row{k}"] = rows[:, k]
        table["first_node"] = self.textures.first_nodes[mesh]
        table["first_triangle"] = self.textures.first_triangles[mesh]
        table["leaves"] = np.array([tree.tree.leaves for tree in trees])[mesh]
        table["per_leaf"] = np.array([tree.tree.per_leaf for tree in trees])[mesh]
        table["instance"] = frame.tables["placement"].rows[chosen]
        table["first_own"] = frame.tables["geometry"].first_triangle[mesh]
        frame.tables["casters"] = {
            "tree_nodes": self.textures.nodes,
            "tree_triangles": self.textures.triangles,
            "casters": CASTER.upload(self.device.gl, table[tree.order]),
            "caster_leaves": tree.leaves,
        }
        frame.counts["bytes_uploaded"] += table.nbytes + tree.pairs.nbytes


def boxes_around(linear: np.ndarray, offsets: np.ndarray, parts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Low and high corners (I,3) float32 of what is in boxes (I,B,2,3), moved by linear (I,3,3) and offsets (I,3)."""
    middles, halves = parts.astype(np.float64).mean(2), (parts[:, :, 1] - parts[:, :, 0]) / 2.0
    middles = np.einsum("nij,nbj->nbi", linear, middles) + offsets[:, None]
    halves = np.einsum("nij,nbj->nbi", np.abs(linear), halves)
    low, high = (middles - halves).min(1), (middles + halves).max(1)
    slack = 1e-6 * (np.abs(low) + np.abs(high))
    return (low - slack).astype(np.float32), (high + slack).astype(np.float32)


def inverse_of(linear: np.ndarray) -> np.ndarray:
    """(I,3,3): the inverses of matrices, of which those that flatten are taken to leave a little thickness."""
    u, scales, v = np.linalg.svd(linear)
    scales = np.maximum(scales, np.maximum(FLATTEST * scales[:, :1], np.finfo(np.float32).tiny))
    return np.einsum("nji,nj,nkj->nik", v, 1.0 / scales, u)
