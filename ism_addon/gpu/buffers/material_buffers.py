# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials on the GPU."""

from typing import Any

import numpy as np

from ...scene import MATERIAL_INPUTS, Materials, NodeGraph
from ..gl.context import Device
from ..gl.shader_records import MATERIAL
from ..materials.shader import MaterialShader, material_shader
from .texture_buffer import TextureBuffer, image_constants


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
        constants = image_constants(texels.images)
        self._shaders = {index: material_shader(materials, graphs, constants, index) for index in {-1, *self.graphs}}

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
        return self._shaders[graph]

    def samplers(self, shader: MaterialShader) -> dict[str, Any]:
        """What such a shader reads, by sampler name."""
        return {
            **(self.texels.samplers if shader.reads_images else {}),
            **({"graph_constants": self.constants} if shader.has_graph else {}),
        }
