# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps Mesa's software driver from compiling variants of a shader, a fraction of a second each.

It compiles one variant for textures whose sides are powers of two and one for others; one for buffers of less than 256
bytes and one for larger ones (it reads bits 8 to 15 of a buffer's size as a texture's last level); and one for each
state of each sampler, which for a buffer is the state of the last texture that was bound. So all textures and buffers
have the same properties. It compiles a shader twice, for blocks whose pixels are all drawn and for others, unless
what the target holds has a part in the result, or might have.
"""

from collections.abc import Callable

import moderngl

#: The smallest GL_MAX_TEXTURE_SIZE that OpenGL 4.1 allows.
MAX_SIDE = 1 << 14

#: The smallest GL_MAX_TEXTURE_IMAGE_UNITS that OpenGL 4.1 allows. No shader uses more.
SAMPLERS = 16

#: GL_COLOR_LOGIC_OP. The operation is GL_COPY, unless it is set.
COLOR_LOGIC_OP = 0x0BF2

VERTICES = "void main() { gl_Position = vec4(0.0, 0.0, 0.0, 1.0); }"
PIXELS = f"""
uniform sampler2D all_of_them[{SAMPLERS}];
out vec2 color;
void main() {{ color = vec2({" + ".join(f"textureSize(all_of_them[{k}], 0)" for k in range(SAMPLERS))}); }}
"""


def overwriting(gl: moderngl.Context, name: str) -> Callable[[], None]:
    """Device.overwrite, in a driver of this name. Mesa's software driver has the logical operation "copy"."""

    def overwrite() -> None:
        gl.enable_only(moderngl.NOTHING)
        if name.startswith("llvmpipe"):
            gl.enable_direct(COLOR_LOGIC_OP)

    return overwrite


def side(texels: int) -> int:
    """Side of a texture with room for `texels` texels: not a power of two, except MAX_SIDE and above."""
    return texels if texels & (texels - 1) or texels >= MAX_SIDE else max(3, texels + 1)


def sides(size: tuple[int, int]) -> tuple[int, int]:
    """`side` of width and of height."""
    return side(size[0]), side(size[1])


def rows(count: int, row_bytes: int) -> int:
    """Number of rows, at least `count`, of a buffer whose size needs no other shader variants."""
    while not (count * row_bytes >> 8 & 255 and count * row_bytes & (count * row_bytes - 1)):
        count += 1
    return count


def use_all_samplers(gl: moderngl.Context) -> None:
    """Give each sampler of the fragment stage the state of our textures, see never_filtered."""
    program = gl.program(f"#version 410 core\n{VERTICES}", fragment_shader=f"#version 410 core\n{PIXELS}")
    program["all_of_them"] = [0] * SAMPLERS
    texel, target = gl.texture((1, 1), 4), gl.framebuffer([gl.texture((1, 1), 4)])
    never_filtered(texel)
    target.use()
    texel.use(0)
    gl.vertex_array(program, []).render(moderngl.POINTS, vertices=1)


def never_filtered(texture: moderngl.Texture | moderngl.TextureArray) -> None:
    """Nearest texel, clamped, one mip level: the sampler state of all our textures.

    Integer textures use the nearest mip level in any case, so all others do too.
    """
    texture.build_mipmaps(0, 0)
    texture.filter = moderngl.NEAREST_MIPMAP_NEAREST, moderngl.NEAREST
    texture.repeat_x = texture.repeat_y = False
