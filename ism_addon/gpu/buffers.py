# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the scene's meshes stand, and what they are made of, on the GPU."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..color import linear_from_srgb, srgb_from_linear
from ..scene import Image, Instances, Materials
from . import one_kind
from .context import Device
from .cull import in_view, runs
from .geometry import Geometry
from .layout import INSTANCE, MATERIAL, MEMBERSHIP

SRGB8_ALPHA8 = 0x8C43

#: Texels along a line of the texture that holds images.
WIDTH = 4096


@dataclass(frozen=True)
class Draw:
    """Instances of one mesh: one draw call."""

    first_triangle: int
    triangles: int
    first_instance: int
    instances: int


def portions(draws: Iterator[Draw], most: int) -> Iterator[Draw]:
    """The same in draws of `most` triangles at most, or of one an instance."""
    for draw in draws:
        each = max(most // draw.instances, 1)
        for first in range(0, draw.triangles, each):
            count = min(each, draw.triangles - first)
            yield replace(draw, first_triangle=draw.first_triangle + first, triangles=count)


class Placement:
    """Where the instances stand in anchor space, those of a mesh one behind the other."""

    def __init__(self, device: Device, geometry: Geometry, instances: Instances, anchor: np.ndarray):
        shown = np.flatnonzero(instances.visible)
        order = shown[np.argsort(instances.mesh[shown], kind="stable")]
        #: Where in the table an instance is; -1 for one that is not seen.
        self.rows = np.full(len(instances.mesh), -1)
        self.rows[order] = np.arange(len(order))
        mesh = instances.mesh[order]
        linear, offsets = anchor_from_steps(geometry, instances, order, anchor)
        self.matrices = np.concatenate([linear, offsets[:, :, None]], 2)
        table = np.zeros(len(order), INSTANCE.dtype)
        for k in range(3):
            table[f"row{k}"] = self.matrices[:, k]
        self.table = INSTANCE.upload(device, table)
        groups = np.zeros(len(order), MEMBERSHIP.dtype)
        groups["groups"] = instances.groups[order]
        self.memberships = MEMBERSHIP.upload(device, groups)
        self.bytes = table.nbytes + groups.nbytes
        numbers, first, count = np.unique(mesh, return_index=True, return_counts=True)
        #: By number, all instances of each mesh that is there; and each instance's mesh, -1 if that is not there.
        self.meshes = {
            k: Draw(int(geometry.first_triangle[k]), len(geometry.meshes[k].triangles), int(f), int(c))
            for k, f, c in zip(numbers, first, count, strict=True)
            if k in geometry.trees
        }
        self.mesh = np.where(np.isin(mesh, list(self.meshes)), mesh, -1)
        self.half_sizes = geometry.half_sizes[mesh]

    def draws(self, clip_from_anchor: np.ndarray, margin: float) -> Iterator[Draw]:
        """The instances that can be in the picture, or as far beyond it as cull.py says."""
        clip_from_centre = clip_from_anchor[:, :3] @ self.matrices
        clip_from_centre[..., 3] += clip_from_anchor[:, 3]
        seen = in_view(self.half_sizes, clip_from_centre, margin)
        for first, count in runs(seen, self.mesh):
            yield replace(self.meshes[self.mesh[first]], first_instance=first, instances=count)


class Texels:
    """All images, with their halved copies, in one texture of texels."""

    def __init__(self, device: Device, images: tuple[Image, ...]):
        self.images = images
        chains = [mip_chain(image.texels) for image in images]
        blocks = [padded(np.concatenate(chain)) for chain in chains]
        self.first_lines = np.cumsum([0] + [len(block) // WIDTH for block in blocks])
        self.levels = [len(chain) for chain in chains]
        # A texture, as arrays know no sRGB.
        size = WIDTH, lines_for(int(self.first_lines[-1]))
        self.texture = device.gl.texture(size, 4, dtype="f1", internal_format=SRGB8_ALPHA8)
        one_kind.never_filtered(self.texture)
        for block, line in zip(blocks, self.first_lines[:-1], strict=True):
            self.texture.write(block, viewport=(0, int(line), WIDTH, len(block) // WIDTH))
        self.bytes = sum(block.nbytes for block in blocks)


class Surfaces:
    """Materials as a table that leads into the images' texels."""

    def __init__(self, device: Device, materials: Materials, texels: Texels):
        table = np.zeros(len(materials.base_color), MATERIAL.dtype)
        table["color"] = materials.base_color
        for row in np.flatnonzero(materials.image >= 0):
            number = materials.image[row]
            image = texels.images[number]
            table[row]["first_line"], table[row]["levels"] = texels.first_lines[number], texels.levels[number]
            table[row]["height"], table[row]["width"] = image.texels.shape[:2]
            table[row]["repeat"] = image.repeat
        self.table = MATERIAL.upload(device, table)
        self.texels = texels
        self.bytes = table.nbytes


def anchor_from_steps(
    geometry: Geometry, instances: Instances, rows: np.ndarray, anchor: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Matrices (N,3,3) and offsets (N,3) float64 of some instances, from the steps of their meshes' lattices."""
    mesh, matrices = instances.mesh[rows], instances.world_from_object[rows]
    linear = matrices[:, :3, :3]
    offsets = np.einsum("nij,nj->ni", linear, geometry.centres[mesh]) + matrices[:, :3, 3] - anchor
    return linear / geometry.scales[mesh, None, None], offsets


def lines_for(lines: int) -> int:
    """As many or more: never a power of two, for which Mesa's software driver would compile every shader once more."""
    return max(3, lines | 1)


def padded(texels: np.ndarray) -> np.ndarray:
    """Texels (N,4) with empty ones behind, up to a whole line of the texture: floats count lines exactly."""
    return np.pad(texels, ((0, -len(texels) % WIDTH), (0, 0)))


def mip_chain(texels: np.ndarray) -> list[np.ndarray]:
    """An image (H,W,4) uint8 and its halved copies down to one texel, each as rows of texels (N,4) uint8.

    Averages are taken in linear light, on 16 bits. An odd last row or column joins its neighbour.
    """
    decode = linear_from_srgb(np.arange(256) / 255.0).astype(np.float32)
    encode = np.rint(srgb_from_linear(np.arange(65536) / 65535.0) * 255.0).astype(np.uint8)
    chain = [texels.reshape(-1, 4)]
    linear = decode[texels]
    linear[..., 3] = texels[..., 3] / np.float32(255.0)
    while linear.shape[0] > 1 or linear.shape[1] > 1:
        for axis in (0, 1):
            if linear.shape[axis] > 1:
                linear = halved(linear, axis)
        level = encode[(linear * np.float32(65535.0) + np.float32(0.5)).astype(np.uint16)]
        level[..., 3] = np.rint(linear[..., 3] * 255.0)
        chain.append(level.reshape(-1, 4))
    return chain


def halved(image: np.ndarray, axis: int) -> np.ndarray:
    """Averages of neighbours along an axis; of the last three, if their number is odd."""
    image = np.moveaxis(image, axis, 0)
    pairs = len(image) // 2 * 2
    half = (image[0:pairs:2] + image[1:pairs:2]) * np.float32(0.5)
    if len(image) > pairs:
        half[-1] = (image[pairs - 2] + image[pairs - 1] + image[pairs]) / np.float32(3.0)
    return np.moveaxis(half, 0, axis)
