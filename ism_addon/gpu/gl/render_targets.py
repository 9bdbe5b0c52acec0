# SPDX-License-Identifier: GPL-3.0-or-later
"""The textures of render targets, and the framebuffers around them."""

from collections.abc import Iterable

import moderngl
import numpy as np

from ...resource_types import Target
from . import driver_variants
from .depth import float_depth

#: Texels to a row of a target in strips, as long as they are no longer than this.
TILE_STRIP_WIDTH, MAX_STRIP_HEIGHT = 9, 4100


def size_of(target: Target, width: int, height: int) -> tuple[int, int]:
    """Texels across and up of a target for a picture of this size.

    Texels that are few and take long lie in strips, one row of the picture behind the other: software drivers share
    out a target to cores in parts of 64 by 64 texels or so, of which there would be too few.
    """
    columns, rows = -(-width // target.divisor), -(-height // target.divisor)
    if not target.strips:
        return columns, rows
    across = TILE_STRIP_WIDTH * -(-columns * rows // (TILE_STRIP_WIDTH * MAX_STRIP_HEIGHT))
    return across, driver_variants.side(-(-columns * rows // across))


def create(gl: moderngl.Context, target: Target, size: tuple[int, int]) -> moderngl.Texture:
    """A texture of so many texels or a little more, see driver_variants.py; never filtered."""
    room = driver_variants.sides(size)
    if target.is_depth:
        return float_depth(gl, room)
    texture = gl.texture(room, target.components, dtype=target.dtype)
    driver_variants.never_filtered(texture)
    return texture


def create_neutral(gl: moderngl.Context, target: Target) -> moderngl.Texture:
    """A few texels of the target's neutral value. Raises ValueError if it has none: then a pass must make it."""
    if target.neutral is None:
        raise ValueError(f"nothing can stand for {target.name}, which no pass has made")
    texture = create(gl, target, (1, 1))
    dtype = {"f1": np.uint8, "f2": np.float16, "f4": np.float32, "u4": np.uint32}[target.dtype]
    texel = np.array(target.neutral[: target.components]) * (255 if target.dtype == "f1" else 1)
    texture.write(np.tile(texel.astype(dtype), texture.width * texture.height), alignment=1)
    return texture


class RenderTargets:
    """Allocates a target when it is first needed, or in another size, and frees what it replaces."""

    def __init__(self, gl: moderngl.Context):
        self.gl = gl
        self.textures: dict[Target, moderngl.Texture] = {}
        #: Of what is drawn of each; those that neutral texels stand for have none.
        self.sizes: dict[Target, tuple[int, int]] = {}
        self.framebuffers: dict[tuple[Target, ...], moderngl.Framebuffer] = {}

    def __getitem__(self, target: Target) -> moderngl.Texture:
        return self.textures[target]

    def allocate(self, target: Target, size: tuple[int, int]) -> None:
        """Make sure that a target has this size."""
        if self.sizes.get(target) != size:
            self.release([target])
            self.textures[target], self.sizes[target] = create(self.gl, target, size), size

    def reserve(self, target: Target, size: tuple[int, int]) -> None:
        """Make sure that a target has this size or a larger one."""
        width, height = self.sizes.get(target, (0, 0))
        if width < size[0] or height < size[1]:
            self.allocate(target, size)

    def ensure(self, target: Target) -> None:
        """Let neutral texels stand for a target that no pass has made."""
        if target not in self.textures:
            self.textures[target] = create_neutral(self.gl, target)

    def framebuffer(self, *targets: Target) -> moderngl.Framebuffer:
        """The framebuffer that draws into these targets; the depth buffer, if there is one, comes last."""
        if targets not in self.framebuffers:
            textures = [self.textures[target] for target in targets]
            depth = textures.pop() if textures[-1].depth else None
            self.framebuffers[targets] = self.gl.framebuffer(textures, depth)
            self.framebuffers[targets].viewport = 0, 0, *self.sizes[targets[0]]
        return self.framebuffers[targets]

    def read(self, target: Target) -> np.ndarray:
        """(H,W,components) float32 of a target of floats, bottom row first."""
        width, height = self.sizes[target]
        return np.ascontiguousarray(pixels(self.textures[target])[:height, :width])

    @property
    def bytes(self) -> int:
        """What all of them take."""
        return sum(t.width * t.height * t.components * int(t.dtype[1:]) for t in self.textures.values())

    def release(self, targets: Iterable[Target] | None = None) -> None:
        """Free these targets, or all, with the framebuffers around them."""
        for target in list(self.textures) if targets is None else targets:
            if target in self.textures:
                del self.textures[target]
                self.sizes.pop(target, None)
                for key in [key for key in self.framebuffers if target in key]:
                    del self.framebuffers[key]


def draw_into(target: moderngl.Framebuffer) -> None:
    """Let what is drawn from now on go there. To choose what is chosen already would be a dozen calls of OpenGL."""
    if target.ctx.fbo is not target:
        target.use()


def pixels(texture: moderngl.Texture) -> np.ndarray:
    """(H,W,components) float32 of a texture of floats or of bytes, these as parts of 255."""
    bytes_ = texture.dtype == "f1"
    whole: np.ndarray = np.empty((*texture.size[::-1], texture.components), np.uint8 if bytes_ else np.float32)
    texture.read_into(whole, alignment=1)
    return whole / np.float32(255) if bytes_ else whole
