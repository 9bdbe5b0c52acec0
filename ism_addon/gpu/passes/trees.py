# SPDX-License-Identifier: GPL-3.0-or-later
"""What shadow rays look through: a tree over each mesh's triangles, and one over the instances that cast shadows.

Two levels, as in every ray tracer that moves things: a mesh keeps its tree wherever its instances go.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import reduce
from typing import ClassVar
from weakref import WeakKeyDictionary

import moderngl
import numpy as np

from ...scene import Change, Mesh
from ..buffers import centre_of, joined
from ..context import Device
from ..layout import CASTER, WIDTH, upload_array
from ..tree import NODE, NOWHERE, Tree, build
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
    nodes: np.ndarray  # (leaves // 2,) NODE
    triangles: np.ndarray  # (leaves * per_leaf, 2, 4) uint32: see packed_triangles

    @property
    def parts(self) -> np.ndarray:
        """(PARTS,2,3): boxes around all of the mesh, closer than one box when it is turned."""
        level = min(PARTS, self.tree.leaves)
        boxes = self.tree.nodes[level : 2 * level]
        boxes = boxes[boxes[:, 0, 0] < NOWHERE]
        return boxes[np.arange(PARTS) % len(boxes)]


def mesh_tree(mesh: Mesh) -> MeshTree:
    """The tree of a mesh that has triangles."""
    positions = (mesh.positions - centre_of(mesh.positions)).astype(np.float32)
    corners = [positions[corner] for corner in mesh.triangles.T]
    tree = build(reduce(np.minimum, corners), reduce(np.maximum, corners), TRIANGLES_PER_LEAF)
    steps = np.rint(tree.steps(positions)).astype(np.int32)[mesh.triangles]
    return MeshTree(tree, tree.packed(), packed_triangles(steps, np.arange(len(steps)))[tree.order])


def packed_triangles(corners: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """(T,2,4) uint32: corners (T,3,3) int32 of 25 bits, numbers (T,) of 28.

    The upper bits of the words are all coordinates but the last; the lower seven are that one, and the number.
    """
    words = corners.reshape(-1, 9)[:, :8].view(np.uint32) << np.uint32(7)
    lower = np.stack([corners[:, 2, 2], numbers], 1).astype(np.uint32)
    for k in range(4):
        words[:, k::4] |= lower >> np.uint32(7 * k) & np.uint32(127)
    return words.reshape(-1, 2, 4)


class MeshTable:
    """What of all meshes' trees is asked for by instance, as arrays."""

    def __init__(self, trees: list[MeshTree]):
        self.trees = trees
        parts = np.array([tree.parts for tree in trees], np.float64).reshape(-1, PARTS, 2, 3)
        self.middles, self.halves = parts.mean(2), (parts[:, :, 1] - parts[:, :, 0]) / 2.0  # (M,PARTS,3)
        self.scales = np.array([tree.tree.scale for tree in trees]).reshape(-1, 3)
        self.leaves = np.array([tree.tree.leaves for tree in trees], np.int64)
        self.per_leaf = np.array([tree.tree.per_leaf for tree in trees], np.int64)


class MeshTrees(Pass):
    """A tree for each mesh; a mesh that did not change keeps its own."""

    makes = ("mesh_trees",)
    depends_on = (Change.MESHES,)

    #: The trees of all meshes that still are, for all renderers.
    kept: ClassVar[WeakKeyDictionary[Mesh, MeshTree]] = WeakKeyDictionary()

    def needed(self, frame: Frame) -> bool:
        return frame.traces

    def draw(self, frame: Frame) -> None:
        meshes = frame.scene.meshes
        new = [mesh for mesh in meshes if mesh not in self.kept]
        with ThreadPoolExecutor() as cores:
            self.kept.update(zip(new, cores.map(mesh_tree, new), strict=True))
        frame.tables["mesh_trees"] = MeshTable([self.kept[mesh] for mesh in meshes])


class MeshTextures:
    """The trees of all meshes one behind the other, and before them room for the tree over the instances."""

    def __init__(self, gl: moderngl.Context, trees: list[MeshTree], leaves: int):
        self.lines = -(-leaves // WIDTH)
        room = np.zeros(self.lines * WIDTH // 2, NODE)
        nodes = np.concatenate([room, *(tree.nodes for tree in trees)])
        triangles = joined([tree.triangles.reshape(-1, 4) for tree in trees], (0, 4), "u4")
        self.nodes = upload_array(gl, texels(nodes), "u4")
        self.first_nodes = np.cumsum([len(room)] + [len(tree.nodes) for tree in trees])[:-1]
        self.triangles = upload_array(gl, triangles, "u4")
        self.first_triangles = np.cumsum([0] + [len(tree.triangles) for tree in trees])[:-1]
        self.bytes = triangles.nbytes + nodes.nbytes

    def write_instances(self, nodes: np.ndarray) -> None:
        """The tree over the instances: nodes (leaves // 2,) NODE."""
        room = np.zeros(self.lines * WIDTH // 2, NODE)
        room[: len(nodes)] = nodes
        self.nodes.write(texels(room), viewport=(0, 0, WIDTH, self.lines))


def texels(nodes: np.ndarray) -> np.ndarray:
    """(2 N,4) uint32: rows of NODE as a texture holds them."""
    return nodes.view(np.uint32).reshape(-1, 4)


class InstanceTree(Pass):
    """The tree over the instances that cast shadows; moving one uploads nothing of the meshes."""

    reads = ("mesh_trees", "geometry", "placement")
    makes = ("casters",)
    depends_on = (Change.INSTANCES,)

    def __init__(self, device: Device):
        super().__init__(device)
        self.meshes: MeshTable | None = None
        self.textures: MeshTextures | None = None

    def needed(self, frame: Frame) -> bool:
        return frame.traces

    def draw(self, frame: Frame) -> None:
        meshes, instances = frame.tables["mesh_trees"], frame.scene.instances
        chosen = np.flatnonzero(instances.casts_shadow)
        mesh = instances.mesh[chosen]
        linear = instances.world_from_object[chosen, :3, :3]
        centres = frame.tables["geometry"].centres[mesh]
        offsets = instances.world_from_object[chosen, :3, 3] - frame.anchor + np.einsum("nij,nj->ni", linear, centres)
        low, high = boxes_around(linear, offsets, meshes.middles[mesh], meshes.halves[mesh])
        middle = (low.min(0) + high.max(0)) / 2.0
        tree = build(low - middle, high - middle, 1)
        if self.textures is None or self.meshes is not meshes or tree.leaves > self.textures.lines * WIDTH:
            self.meshes, self.textures = meshes, MeshTextures(self.device.gl, meshes.trees, tree.leaves)
            frame.counts["bytes_uploaded"] += self.textures.bytes
        nodes = tree.packed()
        self.textures.write_instances(nodes)
        table = np.zeros(len(chosen), CASTER.dtype)
        rows = inverse_of(linear, offsets) * meshes.scales[mesh, :, None]
        for k in range(3):
            table[f"row{k}"] = rows[:, k]
        table["first_node"] = self.textures.first_nodes[mesh]
        table["first_triangle"] = self.textures.first_triangles[mesh]
        table["leaves"] = meshes.leaves[mesh]
        table["per_leaf"] = meshes.per_leaf[mesh]
        table["instance"] = frame.tables["placement"].rows[chosen]
        table["groups"] = instances.groups[chosen]
        table["first_own"] = frame.tables["geometry"].first_triangle[mesh]
        frame.tables["casters"] = {
            "tree_nodes": self.textures.nodes,
            "tree_triangles": self.textures.triangles,
            "casters": CASTER.upload(self.device.gl, table[tree.order]),
            "caster_leaves": tree.leaves,
            "casters_middle": tuple(middle),
            "casters_scale": tuple(tree.scale),
        }
        frame.counts["bytes_uploaded"] += table.nbytes + nodes.nbytes


def boxes_around(
    linear: np.ndarray, offsets: np.ndarray, middles: np.ndarray, halves: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Low and high corners (I,3) float32 of boxes of middles and halves (I,B,3), moved by (I,3,3) and (I,3)."""
    turned = linear.swapaxes(1, 2)
    middles = middles @ turned + offsets[:, None]
    halves = halves @ np.abs(turned)
    low, high = (middles - halves).min(1), (middles + halves).max(1)
    slack = 1e-6 * (np.abs(low) + np.abs(high))
    return (low - slack).astype(np.float32), (high + slack).astype(np.float32)


def inverse_of(linear: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """(I,3,4): the inverses of matrices (I,3,3) and offsets (I,3); those that flatten leave a little thickness."""
    u, scales, v = np.linalg.svd(linear)
    scales = np.maximum(scales, np.maximum(FLATTEST * scales[:, :1], np.finfo(np.float32).tiny))
    inverse = np.einsum("nji,nj,nkj->nik", v, 1.0 / scales, u)
    return np.concatenate([inverse, -np.einsum("nij,nj->ni", inverse, offsets)[:, :, None]], 2)
