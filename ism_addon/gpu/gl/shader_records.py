# SPDX-License-Identifier: GPL-3.0-or-later
"""One declaration for data that numpy fills and GLSL reads.

A Record is a row of a table: the table is an Array (OpenGL 4.1 has no storage buffers, and a uniform block may hold no
more than 16 KB). Numbers of kind "int" are stored as floats, exact up to 2^24.
"""

import numpy as np

from .buffer_texture import BufferTexture
from .context import Device

SIZES = {"float": 1, "int": 1, "vec2": 2, "vec3": 3, "vec4": 4}


class Record:
    """A named row of members, each a kind of SIZES."""

    def __init__(self, name: str, **members: str):
        self.name = name
        self.members = members
        self.dtype = np.dtype(
            [(key, "f4", (SIZES[kind],)) if SIZES[kind] > 1 else (key, "f4") for key, kind in members.items()]
        )
        self.texels = -(-self.dtype.itemsize // 16)

    def glsl(self) -> str:
        """A struct of this name and `Name fetch_Name(samplerBuffer table, int row)`."""
        struct = "".join(f"    {kind} {key};\n" for key, kind in self.members.items())
        rows = range(self.texels)
        fetches = "".join(f"    vec4 t{k} = texelFetch(table, {self.texels} * row + {k});\n" for k in rows)
        values, first = [], 0
        for kind in self.members.values():
            floats = [f"t{k // 4}.{'xyzw'[k % 4]}" for k in range(first, first + SIZES[kind])]
            values.append(f"{kind}({', '.join(floats)})")
            first += SIZES[kind]
        return (
            f"struct {self.name} {{\n{struct}}};\n"
            f"{self.name} fetch_{self.name}(samplerBuffer table, int row) {{\n{fetches}"
            f"    return {self.name}({', '.join(values)});\n}}\n"
        )

    def upload(self, device: Device, table: np.ndarray) -> BufferTexture:
        """A table (N,) of this record's dtype."""
        packed = np.zeros((len(table), 4 * self.texels), np.float32)
        packed[:, : self.dtype.itemsize // 4] = table.view(np.float32).reshape(len(table), self.dtype.itemsize // 4)
        return device.array(packed.reshape(-1, 4))


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
MEMBERSHIP = Record("Membership", groups="int")

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
    link_groups="int",
)

#: A Lambertian surface; a width of 0 means that there is no image.
MATERIAL = Record("Material", color="vec3", first_line="int", width="int", height="int", repeat="int", levels="int")

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

#: A light that contributes, and the virtual lights that stand for it.
VIRTUAL_LIGHT_RANGE = Record("VirtualLightRange", light="int", first="int", count="int")

#: A virtual point light: where it is on its light, and cosine and sine by which its shadow map is turned there.
VIRTUAL_LIGHT = Record("VirtualLight", light_uv="vec2", rotation="vec2")
