# SPDX-License-Identifier: GPL-3.0-or-later
"""One declaration for data that numpy fills and GLSL reads.

A Record is a row of a table: the table is a 2D texture, so its number of rows has no limit but memory
(OpenGL 4.1 has no storage buffers, and a uniform block may hold no more than 16 KB). Numbers of kind "int"
are stored as floats, exact up to 2^24.
"""

from collections.abc import Iterable, Iterator

import moderngl
import numpy as np

SIZES = {"float": 1, "int": 1, "vec2": 2, "vec3": 3, "vec4": 4}

#: Width of the textures that hold arrays; GLSL finds element i at (i % WIDTH, i / WIDTH).
WIDTH = 4096

#: Elements that are made ready and written at a time: whole lines, and little enough for a processor's cache.
PORTION = 8 * WIDTH


def lines_for(count: int, of_line: int) -> int:
    """Lines of a texture that holds so many: never a power of two, for which Mesa's software driver would compile every
    shader once more."""
    return max(3, -(-count // of_line) | 1)


class Record:
    """A named row of members, each a kind of SIZES."""

    def __init__(self, name: str, **members: str):
        self.name = name
        self.members = members
        self.dtype = np.dtype(
            [(key, "f4", (SIZES[kind],)) if SIZES[kind] > 1 else (key, "f4") for key, kind in members.items()]
        )
        self.texels = -(-self.dtype.itemsize // 16)
        self.rows = WIDTH // self.texels

    def glsl(self) -> str:
        """A struct of this name and `Name fetch(sampler2D table, int row)`."""
        struct = "".join(f"    {kind} {key};\n" for key, kind in self.members.items())
        fetches = "".join(f"    vec4 t{k} = fetch(table, at + ivec2({k}, 0));\n" for k in range(self.texels))
        values, first = [], 0
        for kind in self.members.values():
            floats = [f"t{k // 4}.{'xyzw'[k % 4]}" for k in range(first, first + SIZES[kind])]
            values.append(f"{kind}({', '.join(floats)})")
            first += SIZES[kind]
        return (
            f"struct {self.name} {{\n{struct}}};\n"
            f"{self.name} fetch_{self.name}(sampler2D table, int row) {{\n"
            f"    ivec2 at = ivec2(row % {self.rows} * {self.texels}, row / {self.rows});\n{fetches}"
            f"    return {self.name}({', '.join(values)});\n}}\n"
        )

    def upload(self, gl: moderngl.Context, table: np.ndarray) -> moderngl.Texture:
        """A table (N,) of this record's dtype as a texture."""
        lines = lines_for(len(table), self.rows)
        floats = np.zeros((lines, WIDTH // self.texels, self.texels * 4), np.float32)
        packed = table.view(np.float32).reshape(len(table), self.dtype.itemsize // 4)
        floats.reshape(-1, self.texels * 4)[: len(table), : packed.shape[1]] = packed
        width = self.rows * self.texels
        texture = gl.texture((width, lines), 4, floats, dtype="f4")
        texture.filter = moderngl.NEAREST, moderngl.NEAREST
        return texture


def array_texture(
    gl: moderngl.Context, count: int, components: int, dtype: str, internal_format: int | None = None
) -> moderngl.Texture:
    """Room for an array (count, components 1…4) in a texture of WIDTH columns."""
    size = WIDTH, lines_for(count, WIDTH)
    texture = gl.texture(size, components, dtype=dtype, internal_format=internal_format)
    texture.filter = moderngl.NEAREST, moderngl.NEAREST
    return texture


def write_array(texture: moderngl.Texture, array: np.ndarray, first: int = 0) -> None:
    """Write an array (N, components) into array_texture's room from element `first` on, which begins a line."""
    array, line = np.ascontiguousarray(array), first // WIDTH
    lines, rest = divmod(len(array), WIDTH)
    if lines:
        texture.write(array[: lines * WIDTH], viewport=(0, line, WIDTH, lines))
    if rest:
        texture.write(array[lines * WIDTH :], viewport=(0, line + lines, rest, 1))


def upload_array(
    gl: moderngl.Context, array: np.ndarray, dtype: str, internal_format: int | None = None
) -> moderngl.Texture:
    """An array (N, components 1…4) as a texture of WIDTH columns, without a padded copy of the whole."""
    texture = array_texture(gl, *array.shape, dtype, internal_format)
    write_array(texture, array)
    return texture


def portions(lengths: Iterable[int], size: int) -> Iterator[list[tuple[int, slice]]]:
    """Arrays of these lengths, one behind the other, in portions of `size`: the pieces of each, by array and slice."""
    pieces, room = [], size
    for index, length in enumerate(lengths):
        first = 0
        while first < length:
            end = min(first + room, length)
            pieces.append((index, slice(first, end)))
            room -= end - first
            first = end
            if not room:
                yield pieces
                pieces, room = [], size
    if pieces:
        yield pieces


def upload_joined(gl: moderngl.Context, arrays: list[np.ndarray], dtype: str) -> moderngl.Texture:
    """Arrays (N, components) as one texture, one behind the other, without a copy of the whole."""
    texture = array_texture(gl, sum(map(len, arrays)), arrays[0].shape[1], dtype)
    for number, pieces in enumerate(portions(map(len, arrays), PORTION)):
        write_array(texture, np.concatenate([arrays[index][part] for index, part in pieces]), number * PORTION)
    return texture


def octahedron_from_directions(directions: np.ndarray) -> np.ndarray:
    """Unit vectors (…,3) as points (…,2) of a square, as lib/octahedron.glsl does (Cigolle et al. 2014)."""
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
    first_start="int",
    per_leaf="int",
    first_triangle="int",
    instance="int",
    groups="int",
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

#: A light that counts, and which light points stand for it.
POINTS_OF_LIGHT = Record("PointsOfLight", light="int", first="int", count="int")

#: A virtual point light: where it is on its light, and cosine and sine by which its shadow map is turned there.
LIGHT_POINT = Record("LightPoint", place="vec2", turn="vec2")
