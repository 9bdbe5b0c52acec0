# SPDX-License-Identifier: GPL-3.0-or-later
"""The textures of render targets, and the framebuffers around them."""

from collections.abc import Iterable

import moderngl
import numpy as np

from ...resource_types import Target
from . import driver_variants
from .depth import float_depth

#: Width of a strip in texels, and maximum height of a target in strips.
TILE_STRIP_WIDTH, MAX_STRIP_HEIGHT = 9, 4100


def size_of(target: Target, width: int, height: int) -> tuple[int, int]:
    """Width and height in texels of a target, for an image of this size in pixels.

    Targets with a texel per tile are laid out in strips: software drivers parallelise over blocks of 64×64 texels, and
    otherwise there would be too few blocks.
    """
    columns, rows = -(-width // target.divisor), -(-height // target.divisor)
    if not target.strips:
        return columns, rows
    across = TILE_STRIP_WIDTH * -(-columns * rows // (TILE_STRIP_WIDTH * MAX_STRIP_HEIGHT))
    return across, driver_variants.side(-(-columns * rows // across))


def create(gl: moderngl.Context, target: Target, size: tuple[int, int]) -> moderngl.Texture:
    """A texture with room for `size` texels, see driver_variants.py."""
    allocated = driver_variants.sides(size)
    if target.is_depth:
        return float_depth(gl, allocated)
    texture = gl.texture(allocated, target.components, dtype=target.dtype)
    driver_variants.never_filtered(texture)
    return texture


def create_neutral(gl: moderngl.Context, target: Target) -> moderngl.Texture:
    """A texture of a few texels with the target's neutral value. Raises ValueError if it has none."""
    if target.neutral is None:
        raise ValueError(f"{target.name} has no neutral value, and no pass has made it")
    texture = create(gl, target, (1, 1))
    dtype = {"f1": np.uint8, "f2": np.float16, "f4": np.float32, "u4": np.uint32}[target.dtype]
    texel = np.array(target.neutral[: target.components]) * (255 if target.dtype == "f1" else 1)
    texture.write(np.tile(texel.astype(dtype), texture.width * texture.height), alignment=1)
    return texture


class RenderTargets:
    """Allocates textures of targets when they are needed or change size."""

    def __init__(self, gl: moderngl.Context):
        self.gl = gl
        self.textures: dict[Target, moderngl.Texture] = {}
        #: Sizes of targets that passes have made; neutral textures are not included.
        self.sizes: dict[Target, tuple[int, int]] = {}
        self.framebuffers: dict[tuple[Target, ...], moderngl.Framebuffer] = {}
        #: Memory of all textures, bytes.
        self.bytes = 0

    def __getitem__(self, target: Target) -> moderngl.Texture:
        return self.textures[target]

    def allocate(self, target: Target, size: tuple[int, int]) -> None:
        """Make sure that a target has this size."""
        if self.sizes.get(target) != size:
            self.release([target])
            self._keep(target, create(self.gl, target, size))
            self.sizes[target] = size

    def reserve(self, target: Target, size: tuple[int, int]) -> None:
        """Make sure that a target has this size or a larger one."""
        width, height = self.sizes.get(target, (0, 0))
        if width < size[0] or height < size[1]:
            self.allocate(target, size)

    def ensure(self, target: Target) -> None:
        """Make the neutral texture of a target that no pass has made."""
        if target not in self.textures:
            self._keep(target, create_neutral(self.gl, target))

    def _keep(self, target: Target, texture: moderngl.Texture) -> None:
        self.textures[target] = texture
        self.bytes += bytes_of(texture)

    def framebuffer(self, *targets: Target) -> moderngl.Framebuffer:
        """The framebuffer of these targets; a depth buffer, if any, comes last."""
        if targets not in self.framebuffers:
            textures = [self.textures[target] for target in targets]
            depth = textures.pop() if textures[-1].depth else None
            self.framebuffers[targets] = self.gl.framebuffer(textures, depth)
            self.framebuffers[targets].viewport = 0, 0, *self.sizes[targets[0]]
        return self.framebuffers[targets]

    def read(self, target: Target) -> np.ndarray:
        """(H,W,components) float32, or uint32 of a target of integers; bottom row first."""
        width, height = self.sizes[target]
        return np.ascontiguousarray(pixels(self.textures[target])[:height, :width])

    def release(self, targets: Iterable[Target] | None = None) -> None:
        """Free these targets, or all, with their framebuffers."""
        for target in list(self.textures) if targets is None else targets:
            if target in self.textures:
                self.bytes -= bytes_of(self.textures.pop(target))
                self.sizes.pop(target, None)
                for key in [key for key in self.framebuffers if target in key]:
                    del self.framebuffers[key]


def bytes_of(texture: moderngl.Texture) -> int:
    """Memory of a texture, bytes."""
    texel: int = texture.components * int(texture.dtype[1:])
    return texture.width * texture.height * texel


def draw_into(target: moderngl.Framebuffer) -> None:
    """Bind a framebuffer if it is not bound: moderngl makes a dozen OpenGL calls to bind one."""
    if target.ctx.fbo is not target:
        target.use()


def pixels(texture: moderngl.Texture) -> np.ndarray:
    """(H,W,components) float32 of a texture of floats, or of bytes, divided by 255; uint32 of one of integers."""
    dtype = {"f1": np.uint8, "f2": np.float16, "f4": np.float32, "u4": np.uint32}[texture.dtype]
    values: np.ndarray = np.empty((*texture.size[::-1], texture.components), dtype)
    texture.read_into(values, alignment=1)
    if texture.dtype == "f2":
        return values.astype(np.float32)
    return values / np.float32(255) if texture.dtype == "f1" else values
