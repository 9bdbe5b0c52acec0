# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials on the GPU."""

from typing import Any, NamedTuple

import numpy as np

from ...scene import MATERIAL_INPUTS, Materials, NodeGraph
from ..gl.context import Device
from ..gl.shader_compiler import Include
from ..gl.shader_records import MATERIAL
from ..materials import compiler
from .texture_buffer import TextureBuffer


class MaterialShader(NamedTuple):
    """The parts of a shader that draws the materials of one graph."""

    includes: tuple[Include, ...]
    constants: dict[str, Any]
    samplers: dict[str, Any]
    reads_uvs: bool
    reads_attributes: bool
    reads_objects: bool
    has_gloss: bool


class MaterialBuffers:
    """The table of materials, which refers to images and to the constants of graphs."""

    def __init__(self, device: Device, materials: Materials, graphs: tuple[NodeGraph, ...], texels: TextureBuffer):
        table = np.zeros(materials.row_count, MATERIAL.dtype)
        for name in (*MATERIAL_INPUTS, "image", "emission", "graph", "first_constant"):
            table[name] = getattr(materials, name)
        self._device, self._table = device, table
        self.table = MATERIAL.upload(device, table)
        self.constants = device.buffer_from(materials.constants)
        self.texels = texels
        self.emissive = bool(materials.emission.any() or (materials.emission_graph >= 0).any())
        #: Indices of the graphs that any material has; -1 for materials without.
        self.graphs: list[int] = np.unique(materials.graph).tolist() or [-1]
        self._left_out: list[int] = []
        self.bytes = table.nbytes + materials.constants.nbytes
        self._node_graphs = graphs
        self._has_images = bool((materials.image[materials.graph < 0] >= 0).any())
        self._sources = {index: compiler.glsl(graphs[index]) for index in self.graphs if index >= 0}

    def leave_out(self, graph: int) -> int:
        """Draw the materials of a graph, which cannot be compiled, in their base color. Returns their number."""
        self._left_out.append(graph)
        rows = self._table["graph"] == graph
        self._table["graph"][rows] = -1
        self.graphs = np.unique(self._table["graph"]).tolist()
        self.table = MATERIAL.upload(self._device, self._table)
        return int(np.count_nonzero(rows))

    def bits(self, graph: int) -> int:
        """Bits of find_graphs.frag for the materials that are drawn with a graph, or for -1 without one."""
        drawn = [graph, *self._left_out] if graph < 0 else [graph]
        return int(np.bitwise_or.reduce([1 << (each + 1 & 31) for each in drawn]))

    def shader(self, graph: int) -> MaterialShader:
        """What draws the materials of a graph, or for -1 of none."""
        node_graph = self._node_graphs[graph] if graph >= 0 else None
        has_gloss = node_graph is not None and node_graph.has_gloss
        has_images = self._has_images if node_graph is None else node_graph.uses("image")
        return MaterialShader(
            includes=() if node_graph is None else (self._sources[graph],),
            constants={
                "graph": int(node_graph is not None),
                "glossy": int(has_gloss),
                **({"several_graphs": 1} if len(self.graphs) > 1 else {}),
                "images": int(has_images),
                **(self.texels.constants if has_images else {}),
            },
            samplers={
                **(self.texels.samplers if has_images else {}),
                **({} if node_graph is None else {"graph_constants": self.constants}),
            },
            reads_uvs=has_images if node_graph is None else node_graph.uses("uv_map"),
            reads_attributes=node_graph is not None and node_graph.uses("mesh_attribute"),
            reads_objects=node_graph is not None and node_graph.reads_objects,
            has_gloss=has_gloss,
        )
