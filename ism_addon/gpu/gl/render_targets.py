# SPDX-License-Identifier: GPL-3.0-or-later
"""The textures that passes draw into, by name, and the framebuffers around them."""

from collections.abc import Iterable
from dataclasses import dataclass

import moderngl
import numpy as np

from . import driver_variants
from .depth import float_depth

#: What a depth buffer's Target has for a dtype.
DEPTH = "depth"

#: Texels to a row of a target in strips, as long as they are no longer than this.
TILE_STRIP_WIDTH, MAX_STRIP_HEIGHT = 9, 4100


@dataclass(frozen=True)
class Target:
    """A texture that a pass writes: the size of the picture over `divisor`, or for 0 a size of the pass's own.

    Where the pass is not needed, a few texels of `neutral` stand for it, so shaders need no variant without it.

    Its texture may be a little larger, see driver_variants.py: nobody looks at the rest.

    Texels that are few and take long lie in strips, one row of the picture behind the other: drivers share targets out
    to cores by tiles of 64 by 64 texels or so, of which there would be too few.
    """

    components: int
    dtype: str
    neutral: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    divisor: int = 1
    strips: bool = False

    def size(self, width: int, height: int) -> tuple[int, int]:
        """For a picture of this size."""
        columns, rows = -(-width // self.divisor), -(-height // self.divisor)
        if not self.strips:
            return columns, rows
        across = TILE_STRIP_WIDTH * -(-columns * rows // (TILE_STRIP_WIDTH * MAX_STRIP_HEIGHT))
        return across, driver_variants.side(-(-columns * rows // across))

    def create(self, gl: moderngl.Context, size: tuple[int, int]) -> moderngl.Texture:
        """A texture of this kind for so many texels, never filtered."""
        room = driver_variants.sides(size)
        if self.dtype == DEPTH:
            return float_depth(gl, room)
        texture = gl.texture(room, self.components, dtype=self.dtype)
        driver_variants.never_filtered(texture)
        return texture

    def use_neutral(self, texture: moderngl.Texture) -> None:
        """Fill a texture of this kind."""
        if self.dtype != DEPTH:
            dtype = {"f1": np.uint8, "f2": np.float16, "f4": np.float32, "u4": np.uint32}[self.dtype]
            texel = np.array(self.neutral[: self.components]) * (255 if self.dtype == "f1" else 1)
            texture.write(np.tile(texel.astype(dtype), texture.width * texture.height), alignment=1)


class Targets:
    """Allocates a target when it is first wanted or wanted in another size, and frees what it replaces."""

    def __init__(self, gl: moderngl.Context):
        self.gl = gl
        self.textures: dict[str, moderngl.Texture] = {}
        #: Of what is drawn of each.
        self.sizes: dict[str, tuple[int, int]] = {}
        self.framebuffers: dict[tuple[str, ...], moderngl.Framebuffer] = {}

    def __getitem__(self, name: str) -> moderngl.Texture:
        return self.textures[name]

    def allocate(self, name: str, target: Target, size: tuple[int, int]) -> None:
        """Make sure that `name` is a target of this size."""
        if self.sizes.get(name) != size:
            self.release([name])
            self.textures[name], self.sizes[name] = target.create(self.gl, size), size

    def reserve(self, name: str, target: Target, size: tuple[int, int]) -> None:
        """Make sure that `name` is a target of this size or larger: pages of new memory take long to come."""
        width, height = self.sizes.get(name, (0, 0))
        if width < size[0] or height < size[1]:
            self.allocate(name, target, size)

    def use_neutral(self, name: str, target: Target) -> None:
        """Let neutral texels stand for a target that nobody draws."""
        self.allocate(name, target, (1, 1))
        target.use_neutral(self.textures[name])

    def into(self, *names: str) -> moderngl.Framebuffer:
        """The framebuffer that draws into these targets; the depth buffer, if there is one, comes last."""
        if names not in self.framebuffers:
            textures = [self.textures[name] for name in names]
            depth = textures.pop() if textures[-1].depth else None
            self.framebuffers[names] = self.gl.framebuffer(textures, depth)
            self.framebuffers[names].viewport = 0, 0, *self.sizes[names[0]]
        return self.framebuffers[names]

    def read(self, name: str) -> np.ndarray:
        """(H,W,components) float32 of a target of floats, bottom row first."""
        width, height = self.sizes[name]
        return np.ascontiguousarray(pixels(self.textures[name])[:height, :width])

    @property
    def bytes(self) -> int:
        """What all of them take."""
        return sum(t.width * t.height * t.components * int(t.dtype[1:]) for t in self.textures.values())

    def release(self, names: Iterable[str] | None = None) -> None:
        """Let go of the targets `names`, or all, with the framebuffers around them."""
        for name in list(self.textures) if names is None else names:
            if name in self.textures:
                del self.textures[name], self.sizes[name]
                for key in [key for key in self.framebuffers if name in key]:
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
