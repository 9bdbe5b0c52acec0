# SPDX-License-Identifier: GPL-3.0-or-later
"""What shadow rays look through: a tree over each mesh's triangles, and one over the instances that cast shadows.

Two levels, as in every ray tracer that moves things: a mesh keeps its tree wherever its instances go.
"""

from functools import cached_property
from typing import ClassVar
from weakref import WeakKeyDictionary

import numpy as np

from ....parallel import parallel_map
from ....scene import Change, Mesh
from ...accel.blas import BLAS, DeferredBLAS
from ...accel.bvh import NOTHING, build, packed, quantize_boxes, scale_of
from ...accel.small_blas import build_all_blas
from ...buffers.instance_buffers import anchor_from_steps
from ...buffers.small_meshes import in_groups, joined
from ...frame import Frame, Pass
from ...gl.context import Device
from ...gl.shader_records import CASTER

#: An axis that an instance squeezes to less than this part of its longest is kept as long: flat things have two sides.
MIN_AXIS_RATIO = 1e-6

#: What fills less than this of its longest axis cubed is looked at for such axes.
FLAT_VOLUME = 1e-4

#: Instances that are bounded at a time: their boxes stay in a processor's cache.
INSTANCES_AT_A_TIME = 1 << 9


class BLASTable:
    """The trees of the wanted meshes, and what of them is asked for by instance, as arrays: when they are uploaded."""

    def __init__(self, meshes: tuple[Mesh, ...], made: dict[int, BLAS | DeferredBLAS]):
        self.meshes, self.made = meshes, made
        #: (M,): where in the arrays below a mesh of the scene is; -1 for those that are not.
        self.rows = np.full(len(meshes), -1)
        self.rows[list(made)] = np.arange(len(made))

    @cached_property
    def trees(self) -> tuple[BLAS, ...]:
        """One a wanted mesh."""
        return tuple(each.tree for each in self.made.values())

    @cached_property
    def boxes(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Of all that have P parts, for each such P: which (W,) they are, and middles and halves (3,N,P) of the parts.

        Which of them it is by mesh: -1 for others.
        """
        counts, found = np.array([len(tree.parts) for tree in self.trees], np.int64), []
        for count in np.unique(counts).tolist():
            own = np.flatnonzero(counts == count)
            which = np.full(len(counts), -1)
            which[own] = np.arange(len(own))
            parts = np.concatenate([self.trees[number].parts for number in own]).astype(np.float64)
            low, high = parts.reshape(-1, count, 2, 3).transpose(2, 3, 0, 1)
            found.append((which, (low + high) / 2.0, (high - low) / 2.0))
        return found

    @cached_property
    def leaves(self) -> np.ndarray:
        """(W,) int64."""
        return np.array([tree.leaves for tree in self.trees], np.int64)

    @cached_property
    def per_leaf(self) -> np.ndarray:
        """(W,) int64: triangles."""
        return np.array([tree.per_leaf for tree in self.trees], np.int64)


class BuildBLAS(Pass):
    """A tree for each wanted mesh, or its runs; a mesh that did not change keeps its own."""

    compares = ("wanted",)
    makes = ("mesh_trees",)
    depends_on = (Change.MESHES,)

    #: The trees of all meshes that still are, for all renderers.
    kept: ClassVar[WeakKeyDictionary[Mesh, BLAS]] = WeakKeyDictionary()

    def needed(self, frame: Frame) -> bool:
        """Once triangles lie in the order of their trees, they are left so."""
        known = frame.tables.get("mesh_trees")
        return frame.traces or (known is not None and known.meshes == frame.scene.meshes)

    def draw(self, frame: Frame) -> None:
        meshes = frame.scene.meshes
        wanted = {number: meshes[number] for number in frame.tables["wanted"]}
        new = [mesh for mesh in wanted.values() if mesh not in self.kept]
        self.kept.update(zip(new, build_all_blas(new), strict=True))
        frame.tables["mesh_trees"] = BLASTable(meshes, {number: self.kept[mesh] for number, mesh in wanted.items()})


class BLASBuffers:
    """Trees of meshes one behind the other."""

    def __init__(self, device: Device, trees: tuple[BLAS, ...]):
        self.first_nodes = np.cumsum([0] + [len(tree.nodes) for tree in trees])
        self.first_starts = np.cumsum([0] + [tree.leaves for tree in trees])
        self.nodes = device.room(2 * int(self.first_nodes[-1]), 4, "u4")
        self.starts = device.room(int(self.first_starts[-1]), 1, "u4")
        for group in in_groups([tree.leaves for tree in trees]):  # small ones in one write
            some, first = trees[group], group.start
            self.nodes.write(joined([rows_of(tree.nodes) for tree in some]), 2 * int(self.first_nodes[first]))
            self.starts.write(joined([tree.starts for tree in some]), int(self.first_starts[first]))
        self.bytes = sum(tree.starts.nbytes + tree.nodes.nbytes for tree in trees)


def rows_of(nodes: np.ndarray) -> np.ndarray:
    """(2 N,4) uint32: NODEs as an array holds them, two rows each."""
    return nodes.view(np.uint32).reshape(-1, 4)


class BuildTLAS(Pass):
    """The tree over the instances that cast shadows, when all meshes have theirs; moving one uploads no mesh."""

    reads = ("mesh_trees", "geometry", "placement")
    makes = ("casters",)
    depends_on = (Change.INSTANCES,)

    def __init__(self, device: Device):
        super().__init__(device)
        self.meshes: BLASTable | None = None
        self.arrays: BLASBuffers | None = None

    def needed(self, frame: Frame) -> bool:
        return frame.traces

    def draw(self, frame: Frame) -> None:
        meshes, instances = frame.tables["mesh_trees"], frame.scene.instances
        chosen = np.flatnonzero(instances.casts_shadow & (meshes.rows[instances.mesh] >= 0))
        mesh = instances.mesh[chosen]
        row, geometry = meshes.rows[mesh], frame.tables["geometry"]
        linear, offsets = anchor_from_steps(geometry, instances, chosen, frame.anchor)
        low, high = (np.empty((len(chosen), 3), np.float32) for _ in range(2))
        for which, middles, halves in meshes.boxes:
            own = np.flatnonzero(which[row] >= 0)
            low[own], high[own] = instance_bounds(linear[own], offsets[own], which[row[own]], middles, halves)
        middle, scale, boxes = on_grid(low, high) if len(chosen) else (np.zeros(3), np.ones(3), NOTHING)
        tree = build(boxes, 1)
        if self.arrays is None or self.meshes is not meshes:
            self.meshes, self.arrays = meshes, BLASBuffers(self.device, meshes.trees)
            frame.counts["bytes_uploaded"] += self.arrays.bytes
        nodes = rows_of(packed(tree.nodes))
        table = np.zeros(len(chosen), CASTER.dtype)
        inverse = inverse_of(linear, offsets)
        for k in range(3):
            table[f"row{k}"] = inverse[:, k]
        table["first_node"] = self.arrays.first_nodes[row]
        table["first_start"] = self.arrays.first_starts[row]
        table["leaves"] = meshes.leaves[row]
        table["per_leaf"] = meshes.per_leaf[row]
        table["first_triangle"] = geometry.first_triangle[mesh]
        table["instance"] = frame.tables["placement"].rows[chosen]
        table["groups"] = instances.groups[chosen]
        frame.tables["casters"] = {
            "tree_nodes": self.arrays.nodes,
            "tree_starts": self.arrays.starts,
            "corners": geometry.arrays["corners"],
            "caster_nodes": self.device.array(nodes),
            "casters": CASTER.upload(self.device, np.append(table, np.zeros(1, CASTER.dtype))[tree.order]),
            "caster_leaves": tree.leaves,
            "casters_middle": tuple(middle),
            "casters_scale": tuple(scale),
        }
        frame.counts["bytes_uploaded"] += table.nbytes + nodes.nbytes


def on_grid(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The middle (3,) and the scale (3,) of the grid that just holds boxes (N,3), and them on it (2,3,N) in planes."""
    middle = (low.min(0) + high.max(0)) / 2.0
    scale = scale_of(np.maximum(high - middle, middle - low).max(0))
    return middle, scale, quantize_boxes(np.stack([((corner - middle) * scale).T for corner in (low, high)]))


def instance_bounds(
    linear: np.ndarray, offsets: np.ndarray, mesh: np.ndarray, middles: np.ndarray, halves: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Low and high corners (I,3) float32 of instances, whose mesh (I,) has boxes of middles and halves (3,M,B).

    They are moved by (I,3,3) and (I,3). Boxes lie side by side: numpy is slow along short axes.
    """
    low, high = (np.empty((len(mesh), 3)) for _ in range(2))

    def fill(first: int) -> None:
        part = slice(first, first + INSTANCES_AT_A_TIME)
        own_middles, own_halves = (of_meshes[:, mesh[part]] for of_meshes in (middles, halves))
        for axis in range(3):
            row = linear[part, axis, :, None]
            middle = sum(row[:, k] * own_middles[k] for k in range(3)) + offsets[part, axis, None]
            half = sum(np.abs(row[:, k]) * own_halves[k] for k in range(3))
            low[part, axis], high[part, axis] = (middle - half).min(1), (middle + half).max(1)

    parallel_map(fill, range(0, len(mesh), INSTANCES_AT_A_TIME), middles.shape[2] * len(mesh))
    slack = 1e-6 * (np.abs(low) + np.abs(high))
    return (low - slack).astype(np.float32), (high + slack).astype(np.float32)


def inverse_of(linear: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """(I,3,4): the inverses of matrices (I,3,3) and offsets (I,3); those that flatten leave a little thickness."""
    a, b, c = np.ascontiguousarray(linear.transpose(1, 2, 0))
    columns = np.stack([np.cross(*pair, axis=0) for pair in ((b, c), (c, a), (a, b))])
    volume = (a * columns[0]).sum(0)
    flat = np.abs(volume) <= FLAT_VOLUME * (linear * linear).sum((1, 2)) ** 1.5
    inverse = (columns / np.where(flat, 1.0, volume)).transpose(2, 1, 0)
    inverse[flat] = inverse_of_flat(linear[flat])
    return np.concatenate([inverse, -np.einsum("nij,nj->ni", inverse, offsets)[:, :, None]], 2)


def inverse_of_flat(linear: np.ndarray) -> np.ndarray:
    """(I,3,3): the inverses of (I,3,3), whose shortest axes count as longer."""
    u, scales, v = np.linalg.svd(linear)
    scales = np.maximum(scales, np.maximum(MIN_AXIS_RATIO * scales[:, :1], np.finfo(np.float32).tiny))
    return np.einsum("nji,nj,nkj->nik", v, 1.0 / scales, u)
