# SPDX-License-Identifier: GPL-3.0-or-later
"""What keeps Mesa's software driver from compiling a shader again for what it is given: a part of a second each time.

It compiles for textures whose sides are powers of two and for those whose are not, for buffers of less than 256 bytes
and for larger ones (what it takes for a texture's last level are bits 8 to 15 of a buffer's size), and for the state of
each sampler, which for a buffer is whatever was there before. So all that we give it is of one kind.
"""

import moderngl

#: The longest side of a texture that any OpenGL 4.1 can have.
MAX_SIDE = 1 << 14

#: Samplers that OpenGL 4.1 has at least for each stage, and no shader of ours has more.
SAMPLERS = 16

VERTICES = "void main() { gl_Position = vec4(0.0, 0.0, 0.0, 1.0); }"
PIXELS = f"""
uniform sampler2D all_of_them[{SAMPLERS}];
out vec4 color;
void main() {{ color = {" + ".join(f"texelFetch(all_of_them[{k}], ivec2(0), 0)" for k in range(SAMPLERS))}; }}
"""


def side(texels: int) -> int:
    """As many texels or one more, or three, for a side of a texture: no power of two, unless that is the longest."""
    return texels if texels & (texels - 1) or texels >= MAX_SIDE else max(3, texels + 1)


def sides(size: tuple[int, int]) -> tuple[int, int]:
    """The same of both."""
    return side(size[0]), side(size[1])


def rows(count: int, each: int) -> int:
    """As many rows of `each` bytes or a few more, for a buffer."""
    while not (count * each >> 8 & 255 and count * each & (count * each - 1)):
        count += 1
    return count


def use_all_samplers(gl: moderngl.Context) -> None:
    """Give each sampler of the fragment stage the state that all textures of ours have."""
    program = gl.program(f"#version 410 core\n{VERTICES}", fragment_shader=f"#version 410 core\n{PIXELS}")
    program["all_of_them"] = [0] * SAMPLERS
    texel, target = gl.texture((1, 1), 4), gl.framebuffer([gl.texture((1, 1), 4)])
    never_filtered(texel)
    target.use()
    texel.use(0)
    gl.vertex_array(program, []).render(moderngl.POINTS, vertices=1)


def never_filtered(texture: moderngl.Texture) -> None:
    """Nor repeated: the state that all textures of ours have.

    That of whole numbers takes the nearest of its levels, whatever it is told; so all do, and have but one.
    """
    texture.build_mipmaps(0, 0)
    texture.filter = moderngl.NEAREST_MIPMAP_NEAREST, moderngl.NEAREST
    texture.repeat_x = texture.repeat_y = False
