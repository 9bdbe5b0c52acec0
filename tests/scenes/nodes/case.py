# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that show a shader node with some options: surfaces, beside which Cycles' pictures can be held.

The node's first inputs vary over the plane, the others have values that are not their defaults. What it gives is
brought into the range of colours.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from mathutils import Euler, Matrix

#: Faces along a side, of shapes that have more than one.
FACES = {"grid": 3, "curved": 24}
#: Shapes whose objects are rotated, and scaled differently along their axes; and those whose mesh shows its back.
TRANSFORMED = "tilted", "back", "mirrored", "curved", "instance"
REVERSED = "back", "mirrored"
EULER, SCALE = Euler((0.5, 0.4, 0.9)), (0.8, 1.3, 0.6)
SECOND_UV_MAP = "Second"
#: Attributes of the grid, with their types and domains.
ATTRIBUTES = {
    "Byte Corners": ("BYTE_COLOR", "CORNER"),
    "Byte Points": ("BYTE_COLOR", "POINT"),
    "Float Corners": ("FLOAT_COLOR", "CORNER"),
    "Float Points": ("FLOAT_COLOR", "POINT"),
    "Whole Numbers": ("INT", "FACE"),
    "Small Numbers": ("INT8", "POINT"),
    "Flags": ("BOOLEAN", "FACE"),
    "Edge Flags": ("BOOLEAN", "EDGE"),
    "Edge Whole Numbers": ("INT", "EDGE"),
    "Edge Numbers": ("FLOAT", "EDGE"),
    "Pairs": ("FLOAT2", "POINT"),
    "Vectors": ("FLOAT_VECTOR", "POINT"),
}
#: What items of attributes are set by, and how many numbers each has.
COLOR = "color", 4
COMPONENTS = {"FLOAT2": ("vector", 2), "FLOAT_VECTOR": ("vector", 3), "FLOAT_COLOR": COLOR, "BYTE_COLOR": COLOR}
DTYPES = {"INT": np.int32, "INT8": np.int32, "BOOLEAN": np.bool_}


@dataclass(frozen=True)
class NodeCase:
    """A node with options. `varied`: inputs that vary over the plane, by index or name; `fixed`: values of others."""

    type: str  # bl_idname
    options: Mapping[str, Any] = field(default_factory=dict)
    output: int = 0  # index of the output that is shown
    varied: tuple[int | str, ...] = (0, 1, 2)
    fixed: Mapping[int | str, Any] = field(default_factory=dict)
    prepare: Callable[[bpy.types.Node], None] | None = None  # sets what is no option, such as a ramp's colours
    low: float = -1.0  # of what varies
    high: float = 2.0
    is_whole: bool = False  # whether what varies is rounded down to whole numbers
    label: str = ""
    shape: str = "plane"  # of the object, see add_object

    @property
    def name(self) -> str:
        """The node, its options and its output."""
        options = (f"{key}={value}" for key, value in self.options.items())
        words = self.type.removeprefix("ShaderNode"), *options, self.label, self.shape, f"output {self.output}"
        return " ".join(word for word in words if word)


def options_of(type_: str, *names: str) -> Iterator[dict[str, Any]]:
    """All values of each option, the first value of the others."""
    properties = getattr(bpy.types, type_).bl_rna.properties
    for name in names:
        if name in properties:
            values = properties[name].enum_items.keys() if properties[name].type == "ENUM" else [False, True]
            yield from ({name: value} for value in values)


def build(case: NodeCase, material: bpy.types.Material) -> bool:
    """Make a material that shows the case. Returns whether this release has the node and the output."""
    if not hasattr(bpy.types, case.type):
        return False
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node = tree.nodes.new(case.type)
    for name, value in case.options.items():
        setattr(node, name, value)
    if case.prepare is not None:
        case.prepare(node)
    outputs = [socket for socket in node.outputs if socket.enabled and not getattr(socket, "is_unavailable", False)]
    if case.output >= len(outputs):
        return False
    enabled = [socket for socket in node.inputs if socket.enabled and not getattr(socket, "is_unavailable", False)]
    inputs: dict[int | str, bpy.types.NodeSocket] = {
        **dict(enumerate(enabled)),
        **{each.name: each for each in enabled},
    }
    coordinates = tree.nodes.new("ShaderNodeUVMap")
    for position, index in enumerate(case.varied):
        if index in inputs:
            tree.links.new(varying(tree, coordinates, inputs[index], position, case), inputs[index])
    for index, value in case.fixed.items():
        if index in inputs:
            inputs[index].default_value = value
    output, diffuse = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    # What is shown is within 0 and 1: a third of the value, plus a third.
    scaled = tree.nodes.new("ShaderNodeVectorMath")
    scaled.operation = "MULTIPLY_ADD"
    tree.links.new(outputs[case.output], scaled.inputs[0])
    scaled.inputs[1].default_value = scaled.inputs[2].default_value = (1 / 3, 1 / 3, 1 / 3)
    clamped = tree.nodes.new("ShaderNodeVectorMath")
    clamped.operation = "MINIMUM"
    tree.links.new(scaled.outputs[0], clamped.inputs[0])
    clamped.inputs[1].default_value = (1.0, 1.0, 1.0)
    tree.links.new(clamped.outputs[0], diffuse.inputs["Color"])
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    return True


def varying(
    tree: bpy.types.NodeTree, coordinates: bpy.types.Node, socket: bpy.types.NodeSocket, position: int, case: NodeCase
) -> bpy.types.NodeSocket:
    """An output that varies over the plane, differently for each position, for a socket."""
    mapping = tree.nodes.new("ShaderNodeMapping")
    span = case.high - case.low
    mapping.inputs["Scale"].default_value = (span, span, span)
    mapping.inputs["Location"].default_value = (case.low, case.low + 0.1 * position, case.low + 0.5)
    mapping.inputs["Rotation"].default_value = (0.3 * position, 0.0, 0.9 * position)
    tree.links.new(coordinates.outputs[0], mapping.inputs["Vector"])
    vector = mapping.outputs[0]
    if case.is_whole:
        rounded = tree.nodes.new("ShaderNodeVectorMath")
        rounded.operation = "FLOOR"
        tree.links.new(vector, rounded.inputs[0])
        vector = rounded.outputs[0]
    if socket.type in ("VECTOR", "RGBA"):
        return vector
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(vector, split.inputs[0])
    return split.outputs[position % 2]


def add_object(scene: bpy.types.Scene, shape: str, name: str, material: bpy.types.Material, x: int, y: int) -> None:
    """Add an object to a scene, above the square from (x, y) on.

    `shape`: plane, grid (a plane that has attributes), tilted, back, mirrored, curved or instance.
    """
    scale = (-SCALE[0], *SCALE[1:]) if shape == "mirrored" else SCALE
    matrix = Matrix.LocRotScale((x + 0.3, y + 0.6, 0.2), EULER, scale) if shape in TRANSFORMED else Matrix()
    count = FACES.get(shape, 1) + 1
    v, u = np.meshgrid(np.linspace(0.0, 1.0, count), np.linspace(0.0, 1.0, count), indexing="ij")
    world = np.stack([x + u, y + v, heights(shape, u, v), np.ones_like(u)], -1).reshape(-1, 4)
    index = np.arange(count * count).reshape(count, count)
    quads = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], -1).reshape(-1, 4)
    quads = quads[:, ::-1] if shape in REVERSED else quads
    uvs = np.stack([u, v], -1).reshape(-1, 2)[quads.ravel()]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata((world @ np.linalg.inv(matrix).T)[:, :3].tolist(), [], quads.tolist())
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", uvs.astype(np.float32).ravel())
    if shape == "curved":
        mesh.shade_smooth()
    if shape == "grid":
        add_attributes(mesh, uvs)
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    thing.color, thing.pass_index = (0.2, 0.5, 0.8, 0.6), 2
    if shape == "instance":
        inner, holder = bpy.data.collections.new(name), bpy.data.objects.new(f"{name} holder", None)
        inner.objects.link(thing)
        holder.instance_type, holder.instance_collection = "COLLECTION", inner
        thing = holder
    thing.matrix_world = matrix
    scene.collection.objects.link(thing)


def heights(shape: str, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """z of a shape's points."""
    if shape == "curved":
        return 0.3 * np.sin(2.2 * u + 0.4) * np.cos(2.6 * v)
    return 0.6 * u - 0.3 * v if shape in TRANSFORMED else np.zeros_like(u)


def add_attributes(mesh: bpy.types.Mesh, uvs: np.ndarray) -> None:
    """Add a second UV map and attributes whose values are random."""
    second = np.stack([0.3 + uvs[:, 1] * 0.6, uvs[:, 0] ** 2], -1)
    mesh.uv_layers.new(name=SECOND_UV_MAP).uv.foreach_set("vector", second.astype(np.float32).ravel())
    random = np.random.default_rng(1)
    for name, (data_type, domain) in ATTRIBUTES.items():
        attribute = mesh.attributes.new(name, data_type, domain)
        prop, size = COMPONENTS.get(data_type, ("value", 1))
        values = random.random(len(attribute.data) * size)
        dtype = DTYPES.get(data_type, np.float32)
        attribute.data.foreach_set(prop, (values if dtype is np.float32 else np.round(values)).astype(dtype))
    mesh.color_attributes.render_color_index = list(mesh.color_attributes.keys()).index("Float Corners")
