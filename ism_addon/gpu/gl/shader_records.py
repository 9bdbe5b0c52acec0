# SPDX-License-Identifier: GPL-3.0-or-later
"""One declaration for data that numpy fills and GLSL reads.

A Record is the type of a table's rows. The table is a buffer texture (OpenGL 4.1 has no storage buffers, and uniform
blocks are limited to 16 KB), or a range of SceneRecords, the buffer texture of tables that shaders read together. A
texel is four 32-bit words. Its format is of integers: in float formats, integers with the bit patterns of NaNs and
denormal numbers might be changed.
"""

from typing import NamedTuple

import numpy as np

from ...scene import MATERIAL_INPUTS
from .buffer_texture import BufferTexture, RecordTable, SceneRecords
from .context import Device

#: Words in a texel.
TEXEL_WORDS = 4


class MemberType(NamedTuple):
    """A type of members."""

    dtype: str  # numpy's dtype of a word
    words: int
    from_bits: str  # GLSL function that converts a uint or uvec to it


MEMBER_TYPES = {
    "float": MemberType("f4", 1, "uintBitsToFloat"),
    "vec2": MemberType("f4", 2, "uintBitsToFloat"),
    "vec3": MemberType("f4", 3, "uintBitsToFloat"),
    "vec4": MemberType("f4", 4, "uintBitsToFloat"),
    "int": MemberType("i4", 1, "int"),
    "ivec2": MemberType("i4", 2, "ivec2"),
    "uint": MemberType("u4", 1, ""),
    "uvec2": MemberType("u4", 2, ""),
}


class Record:
    """A named type of rows; members have types of MEMBER_TYPES."""

    def __init__(self, name: str, **members: str):
        self.name = name
        self.members = members
        types = {member: MEMBER_TYPES[type_] for member, type_ in members.items()}
        self.dtype = np.dtype(
            [(member, dtype, words) if words > 1 else (member, dtype) for member, (dtype, words, _) in types.items()]
        )
        self.texels = -(-self.dtype.itemsize // (4 * TEXEL_WORDS))

    def glsl(self) -> str:
        """A struct of this name and `Name fetch_Name(usamplerBuffer table, int row)`."""
        struct = "".join(f"    {type_} {member};\n" for member, type_ in self.members.items())
        rows = range(self.texels)
        fetches = "".join(f"    uvec4 t{k} = texelFetch(table, {self.texels} * row + {k});\n" for k in rows)
        values, first = [], 0
        for type_ in map(MEMBER_TYPES.__getitem__, self.members.values()):
            words = [f"t{k // TEXEL_WORDS}.{'xyzw'[k % TEXEL_WORDS]}" for k in range(first, first + type_.words)]
            bits = words[0] if type_.words == 1 else f"uvec{type_.words}({', '.join(words)})"
            values.append(f"{type_.from_bits}({bits})")
            first += type_.words
        return (
            f"struct {self.name} {{\n{struct}}};\n"
            f"{self.name} fetch_{self.name}(usamplerBuffer table, int row) {{\n{fetches}"
            f"    return {self.name}({', '.join(values)});\n}}\n"
        )

    def words(self, table: np.ndarray) -> np.ndarray:
        """(N * texels,4) uint32: the texels of a table (N,) of this record's dtype."""
        words = table.view(np.uint32).reshape(len(table), self.dtype.itemsize // 4)
        packed = np.pad(words, ((0, 0), (0, TEXEL_WORDS * self.texels - words.shape[1])))
        return packed.reshape(-1, TEXEL_WORDS)

    def upload(self, device: Device, table: np.ndarray) -> BufferTexture:
        """Upload a table (N,) of this record's dtype."""
        return device.buffer_from(self.words(table))

    def write(self, records: SceneRecords, name: str, table: np.ndarray) -> RecordTable:
        """Write a table (N,) of this record's dtype into the scene's records, under a name."""
        return records.write(name, self.words(table), self.texels)


def octahedron_from_directions(directions: np.ndarray) -> np.ndarray:
    """Unit vectors (…,3) mapped to points (…,2) of a square, as maths/octahedron.glsl does (Cigolle et al. 2014)."""
    points = np.empty((*directions.shape[:-1], 2), directions.dtype)
    x, y, z = (directions[..., k] for k in range(3))  # numpy is slow along short axes
    size = np.maximum(np.abs(x) + np.abs(y) + np.abs(z), 1e-20)
    u, v, below = x / size, y / size, z < 0.0
    points[..., 0] = np.where(below, np.copysign(1.0 - np.abs(v), u), u)
    points[..., 1] = np.where(below, np.copysign(1.0 - np.abs(u), v), v)
    return points


#: Steps of a packed coordinate from 0 to 1.
OCTAHEDRON_STEPS = np.float32(32767.0)


def packed_octahedron(directions: np.ndarray) -> np.ndarray:
    """(…,2) int16 of unit vectors (…,3): the same points, as pack_octahedron in maths/octahedron.glsl packs them."""
    return np.rint(octahedron_from_directions(directions) * OCTAHEDRON_STEPS).astype(np.int16)


def directions_from_octahedron(points: np.ndarray) -> np.ndarray:
    """The inverse: points (…,2) mapped to unit vectors (…,3)."""
    z = 1.0 - np.abs(points).sum(-1, keepdims=True)
    directions = np.concatenate([points - np.copysign(np.maximum(-z, 0.0), points), z], -1)
    directions /= np.sqrt(np.einsum("...k,...k->...", directions, directions))[..., None]
    return directions


#: An instance: the rows of its 3×4 matrix.
INSTANCE = Record("Instance", row0="vec4", row1="vec4", row2="vec4")

#: What graphs read of an instance: how its mesh's quanta are in object space, its origin in world space, and more.
OBJECT_INFO = Record(
    "ObjectInfo",
    centre="vec3",
    metres_per_quantum="float",
    color="vec4",
    location="vec3",
    index="float",
    random="float",
)

#: The link groups of an instance, one bit each.
MEMBERSHIP = Record("Membership", groups="uint")

#: An instance that casts shadows: the 3×4 matrix to its mesh's quanta, the mesh's BLAS (see BLASBuffers), the
#: instance's row in the G-buffer, and its link groups.
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

#: The inputs of a material, its radiance, and its image and graph: -1 means none.
MATERIAL = Record(
    "Material",
    **{name: each.glsl_type for name, each in MATERIAL_INPUTS.items()},
    image="int",
    emission="vec3",
    graph="int",
    first_constant="int",
)

#: For camera rays and for shadow rays: the graph of what passes through a material, -1 if nothing does, and the first
#: of its constants.
MATERIAL_TRANSPARENCY = Record("Transparency", graphs="ivec2", first_constants="ivec2")

#: The graph of the radiance of a material, -1 if it is even, and the first of its constants.
MATERIAL_EMISSION = Record("MaterialEmission", graph="int", first_constant="int")

#: Constants of graphs.
GRAPH_CONSTANT = Record("GraphConstant", numbers="vec4")

#: An image: where its texels are, see textures/image.glsl. After all images, the table has rows for their mip levels,
#: which begin with `first_level`: the size of a level, and as `first_line` its first texel, from the image's on.
IMAGE = Record(
    "Image",
    **dict.fromkeys(("encoding", "first_line", "width", "height", "repeat", "levels", "first_level"), "int"),
    scale="float",
)

#: A light in anchor space. Of areas, x of light space is along the tangent, z along the normal. The radius of suns is
#: the sine of half of their angle. Of emissive meshes: a sphere around the triangles; as axes, two corners of a box;
#: the first rows of their triangles and nodes in the tables of these, see lights/emissive_mesh.glsl; and the largest
#: relative luminance of a triangle.
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
    emission="vec3",
    spread_scale="float",
    radius="float",
    soft_falloff="int",
    shadow_softness="float",
    cone_cosine="float",
    cone_scale="float",
    circular_cone="int",
    receivers="int",
    blockers="int",
    falloff_power="int",
    falloff_smooth="float",
    profile="int",
    profile_x="vec3",
    profile_y="vec3",
    profile_down="vec3",
    image="int",
    image_width="int",
    image_height="int",
    image_repeats="int",
    image_u="vec3",
    image_v="vec3",
    image_w="vec3",
    first_triangle="int",
    triangle_count="int",
    first_node="int",
    leaves="int",
    brightest="float",
)

#: A triangle that emits light, in anchor space: a corner, and the edges from it to the others.
EMISSIVE_TRIANGLE = Record("EmissiveTriangle", corner="vec3", u="vec3", v="vec3", one_sided="int")

#: What it emits relative to its light, if they differ: see EmissiveLights.colors.
EMISSIVE_COLOR = Record("EmissiveColor", color="vec3", luminance="float")

#: A node of a light BVH over emissive triangles, in anchor space, see emission/light_bvh.py. Of symmetric matrices: xx,
#: yy and zz; xy, yz and zx. Of normal_position: rows.
LIGHT_NODE = Record(
    "LightNode",
    centre="vec3",
    radius="float",
    normal="vec3",
    area="float",
    normal_squares="vec3",
    one_sided="int",
    normal_products="vec3",
    normal_sine="float",
    position_squares="vec3",
    position_products="vec3",
    normal_x_position="vec3",
    normal_y_position="vec3",
    normal_z_position="vec3",
)

#: The mean color of a node's triangles.
LIGHT_NODE_COLOR = Record("LightNodeColor", color="vec3")

#: Records of shaders that include lights/light.glsl.
LIGHT_RECORDS = LIGHT, EMISSIVE_TRIANGLE, EMISSIVE_COLOR, LIGHT_NODE, LIGHT_NODE_COLOR

#: Probe rays to one light: its index, the light_uv of the picture's first texel in 32-bit fixed point, and the position
#: of the block's first texel in the picture.
PROBE_BLOCK = Record("ProbeBlock", light="int", light_uv="uvec2", first_texel="ivec2")

#: A contributing light, and the range of its virtual lights.
VIRTUAL_LIGHT_RANGE = Record("VirtualLightRange", light="int", first="int", count="int")

#: A virtual light: the offset of its shadow map's origin from the light's position, the map's axes x and z, along which
#: it faces, and half of the map's width, m; 0: the map is of its hemisphere, not parallel. In anchor space.
VIRTUAL_LIGHT = Record("VirtualLight", offset="vec3", map_radius="float", x_axis="vec3", axis="vec3")
