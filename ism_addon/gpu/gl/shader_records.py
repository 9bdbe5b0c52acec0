# SPDX-License-Identifier: GPL-3.0-or-later
"""One declaration for data that numpy fills and GLSL reads.

A Record is a row of a table: the table is a buffer texture (OpenGL 4.1 has no storage buffers, and a uniform block may
hold no more than 16 KB). Its texels are four 32-bit words each. They are of an integer format: as floats, integers with
the bit patterns of NaNs and of denormal numbers might not arrive.
"""

from typing import NamedTuple

import numpy as np

from ...scene import MATERIAL_INPUTS
from .buffer_texture import BufferTexture
from .context import Device

#: Words in a texel.
TEXEL_WORDS = 4


class Kind(NamedTuple):
    """What a member may be."""

    dtype: str  # numpy's, of a word
    words: int
    from_bits: str  # GLSL: makes one of a uint, or a uvec


KINDS = {
    "float": Kind("f4", 1, "uintBitsToFloat"),
    "vec2": Kind("f4", 2, "uintBitsToFloat"),
    "vec3": Kind("f4", 3, "uintBitsToFloat"),
    "vec4": Kind("f4", 4, "uintBitsToFloat"),
    "int": Kind("i4", 1, "int"),
    "ivec2": Kind("i4", 2, "ivec2"),
    "uint": Kind("u4", 1, ""),
    "uvec2": Kind("u4", 2, ""),
}


class Record:
    """A named row of members, each a kind of KINDS."""

    def __init__(self, name: str, **members: str):
        self.name = name
        self.members = members
        kinds = {member: KINDS[kind] for member, kind in members.items()}
        self.dtype = np.dtype(
            [(member, dtype, words) if words > 1 else (member, dtype) for member, (dtype, words, _) in kinds.items()]
        )
        self.texels = -(-self.dtype.itemsize // (4 * TEXEL_WORDS))

    def glsl(self) -> str:
        """A struct of this name and `Name fetch_Name(usamplerBuffer table, int row)`."""
        struct = "".join(f"    {kind} {member};\n" for member, kind in self.members.items())
        rows = range(self.texels)
        fetches = "".join(f"    uvec4 t{k} = texelFetch(table, {self.texels} * row + {k});\n" for k in rows)
        values, first = [], 0
        for kind in map(KINDS.__getitem__, self.members.values()):
            words = [f"t{k // TEXEL_WORDS}.{'xyzw'[k % TEXEL_WORDS]}" for k in range(first, first + kind.words)]
            bits = words[0] if kind.words == 1 else f"uvec{kind.words}({', '.join(words)})"
            values.append(f"{kind.from_bits}({bits})")
            first += kind.words
        return (
            f"struct {self.name} {{\n{struct}}};\n"
            f"{self.name} fetch_{self.name}(usamplerBuffer table, int row) {{\n{fetches}"
            f"    return {self.name}({', '.join(values)});\n}}\n"
        )

    def upload(self, device: Device, table: np.ndarray) -> BufferTexture:
        """A table (N,) of this record's dtype."""
        words = table.view(np.uint32).reshape(len(table), self.dtype.itemsize // 4)
        packed = np.pad(words, ((0, 0), (0, TEXEL_WORDS * self.texels - words.shape[1])))
        return device.buffer_from(packed.reshape(-1, TEXEL_WORDS))


def octahedron_from_directions(directions: np.ndarray) -> np.ndarray:
    """Unit vectors (…,3) as points (…,2) of a square, as maths/octahedron.glsl does (Cigolle et al. 2014)."""
    points = np.empty((*directions.shape[:-1], 2), directions.dtype)
    x, y, z = (directions[..., k] for k in range(3))  # numpy is slow along short axes
    size = np.maximum(np.abs(x) + np.abs(y) + np.abs(z), 1e-20)
    u, v, below = x / size, y / size, z < 0.0
    points[..., 0] = np.where(below, np.copysign(1.0 - np.abs(v), u), u)
    points[..., 1] = np.where(below, np.copysign(1.0 - np.abs(u), v), v)
    return points


def directions_from_octahedron(points: np.ndarray) -> np.ndarray:
    """The inverse: (…,2) to unit vectors (…,3)."""
    z = 1.0 - np.abs(points).sum(-1, keepdims=True)
    directions = np.concatenate([points - np.copysign(np.maximum(-z, 0.0), points), z], -1)
    directions /= np.sqrt(np.einsum("...k,...k->...", directions, directions))[..., None]
    return directions


#: Where a mesh stands: the rows of its 3×4 matrix.
INSTANCE = Record("Instance", row0="vec4", row1="vec4", row2="vec4")

#: The groups that an instance belongs to, a bit for each.
MEMBERSHIP = Record("Membership", groups="uint")

#: What casts a shadow: the 3×4 matrix into its mesh's steps, that mesh's tree, who it is in the G-buffer, its groups.
CASTER = Record(
    "Caster",
    row0="vec4",
    row1="vec4",
    row2="vec4",
    first_node="int",
    leaves="int",
    first_leaf="int",
    triangles_per_leaf="int",
    first_triangle="int",
    instance="int",
    link_groups="uint",
)

#: The inputs of a material, then its image: a width of 0 means that there is none.
MATERIAL = Record(
    "Material",
    **{name: each.glsl_type for name, each in MATERIAL_INPUTS.items()},
    encoding="int",
    first_line="int",
    width="int",
    height="int",
    repeat="int",
    levels="int",
)

#: An area light in anchor space. Its own space has the tangent for x and the normal for z, from its position.
LIGHT = Record(
    "Light",
    position="vec3",
    shape="int",
    axis_u="vec3",
    axis_v="vec3",
    normal="vec3",
    casts_shadow="int",
    tangent="vec3",
    spread_tangent="float",
    radiance="vec3",
    spread_scale="float",
    receivers="int",
    blockers="int",
)

#: Probe rays to one light: its index, the light_uv of the first texel of the picture in 32-bit fixed point, and which
#: texel of the picture the block's first one is.
PROBE_BLOCK = Record("ProbeBlock", light="int", light_uv="uvec2", first_texel="ivec2")

#: A light that contributes, and the virtual lights that stand for it.
VIRTUAL_LIGHT_RANGE = Record("VirtualLightRange", light="int", first="int", count="int")

#: A virtual point light: from its light's position, in the light's own space, and the cosine and sine by which its
#: shadow map is turned there.
VIRTUAL_LIGHT = Record("VirtualLight", offset="vec3", rotation="vec2")
