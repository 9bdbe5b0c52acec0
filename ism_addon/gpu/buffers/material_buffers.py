# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials and their images on the GPU."""

from collections.abc import Iterable
from typing import Any

import moderngl
import numpy as np

from ...color import linear_from_srgb, srgb_from_linear
from ...scene import MATERIAL_INPUTS, Encoding, Image, Materials, NodeGraph
from ...setting_limits import LAYER_LINES, TEXTURE_WIDTH, images_within_limits, level
from ..gl import driver_variants
from ..gl.buffer_texture import BufferTexture
from ..gl.context import Device
from ..gl.shader_records import IMAGE, MATERIAL
from ..materials.shader import MaterialShader, material_shader

#: Types of texels by the sampler's name.
TEXELS: dict[str, np.dtype] = {"byte_texels": np.dtype(np.uint8), "float_texels": np.dtype(np.float16)}


class TextureBuffer:
    """All images with their mip levels, in one texture of 8-bit texels and one of 16-bit floats, line after line.

    If they exceed a limit, the largest are halved. A texture has several layers if one cannot hold all lines.
    """

    def __init__(self, device: Device, images: tuple[Image, ...]):
        self.images = images
        first_levels = images_within_limits(images)
        chains = [mip_chain(image)[first:] for image, first in zip(images, first_levels, strict=True)]
        blocks = [padded(np.concatenate(chain)) for chain in chains]
        self.levels = [len(chain) for chain in chains]
        self.sizes = [level(image.texels.shape[:2], first) for image, first in zip(images, first_levels, strict=True)]
        self.first_lines = [0] * len(images)
        #: By the sampler's name; only of texels that any image has.
        self.textures: dict[str, moderngl.TextureArray] = {}
        for name, dtype in TEXELS.items():
            indices = [index for index, image in enumerate(images) if image.texels.dtype == dtype]
            if not indices:
                continue
            ends = np.cumsum([0] + [len(blocks[index]) // TEXTURE_WIDTH for index in indices]).tolist()
            layers = -(-ends[-1] // LAYER_LINES)
            lines = LAYER_LINES if layers > 1 else lines_for(ends[-1])
            texture = device.gl.texture_array((TEXTURE_WIDTH, lines, layers), 4, dtype=f"f{dtype.itemsize}")
            driver_variants.never_filtered(texture)
            for index, line in zip(indices, ends[:-1], strict=True):
                self.first_lines[index] = line
                write_lines(texture, blocks[index], line)
            self.textures[name] = texture
        table = np.zeros(len(images), IMAGE.dtype)
        for row, image in zip(table, images, strict=True):
            row["encoding"], row["repeat"] = list(Encoding).index(image.encoding), image.repeat
        table["first_line"], table["levels"] = self.first_lines, self.levels
        if images:
            table["height"], table["width"] = np.transpose(self.sizes)
        self.table = IMAGE.upload(device, table)
        self.bytes = table.nbytes + sum(block.nbytes for block in blocks)

    @property
    def samplers(self) -> dict[str, moderngl.TextureArray | BufferTexture]:
        """The table and the textures by sampler name in textures/image.glsl."""
        return {"images": self.table, **self.textures}


def image_constants(images: Iterable[Image]) -> dict[str, int]:
    """Constants of shaders that read the TextureBuffer of images: the size of layers, and which texels are present."""
    present = {image.texels.dtype for image in images}
    return {"width": TEXTURE_WIDTH, "layer_lines": LAYER_LINES} | {
        f"has_{name}": int(dtype in present) for name, dtype in TEXELS.items()
    }


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
        self.emissive = bool(materials.emission.any())
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


def write_lines(texture: moderngl.TextureArray, texels: np.ndarray, first: int) -> None:
    """Write complete lines of texels (N,4), which may continue in the next layers, from line `first` on."""
    done, count = 0, len(texels) // TEXTURE_WIDTH
    while done < count:
        layer, line = divmod(first + done, LAYER_LINES)
        lines = min(count - done, LAYER_LINES - line)
        portion = texels[done * TEXTURE_WIDTH : (done + lines) * TEXTURE_WIDTH]
        texture.write(np.ascontiguousarray(portion), viewport=(0, line, layer, TEXTURE_WIDTH, lines, 1))
        done += lines


def lines_for(lines: int) -> int:
    """At least `lines` lines, not a power of two, for which llvmpipe would compile other shader variants."""
    return max(3, lines | 1)


def padded(texels: np.ndarray) -> np.ndarray:
    """Texels (N,4), zero-padded to complete lines of the texture, so that each image begins at the start of a line."""
    return np.pad(texels, ((0, -len(texels) % TEXTURE_WIDTH), (0, 0)))


def mip_chain(image: Image) -> list[np.ndarray]:
    """An image and its halved copies down to one texel, each as rows of texels (N,4) of its encoding.

    Averages are taken in linear light. If a side is odd, its last texel is an average of three.
    """
    chain, linear = [image.texels.reshape(-1, 4)], decoded(image)
    while linear.shape[0] > 1 or linear.shape[1] > 1:
        for axis in (0, 1):
            if linear.shape[axis] > 1:
                linear = halved(linear, axis)
        chain.append(encoded(linear, image.encoding).reshape(-1, 4))
    return chain


def decoded(image: Image) -> np.ndarray:
    """(H,W,4) float32: linear values and alpha."""
    if image.encoding is Encoding.FLOAT:
        return image.texels.astype(np.float32)
    values = np.arange(256) / 255.0
    table = (linear_from_srgb(values) if image.encoding is Encoding.SRGB else values).astype(np.float32)
    linear = table[image.texels]
    linear[..., 3] = image.texels[..., 3] / np.float32(255.0)
    return linear


def encoded(linear: np.ndarray, encoding: Encoding) -> np.ndarray:
    """Texels of linear values (H,W,4). sRGB is encoded by a look-up table with 16-bit indices."""
    if encoding is Encoding.FLOAT:
        return linear.astype(np.float16)
    texels = np.rint(linear * 255.0).astype(np.uint8)
    if encoding is Encoding.SRGB:
        table = np.rint(srgb_from_linear(np.arange(65536) / 65535.0) * 255.0).astype(np.uint8)
        texels[..., :3] = table[(linear[..., :3] * np.float32(65535.0) + np.float32(0.5)).astype(np.uint16)]
    return texels


def halved(image: np.ndarray, axis: int) -> np.ndarray:
    """Averages of pairs of texels along an axis; of the last three, if their number is odd."""
    image = np.moveaxis(image, axis, 0)
    pairs = len(image) // 2 * 2
    half = (image[0:pairs:2] + image[1:pairs:2]) * np.float32(0.5)
    if len(image) > pairs:
        half[-1] = (image[pairs - 2] + image[pairs - 1] + image[pairs]) / np.float32(3.0)
    return np.moveaxis(half, 0, axis)
