# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts a tree of nodes to operations of a graph, each node after those that it depends on."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise
from typing import Any, NamedTuple

import bpy
import numpy as np

from ....scene import MATERIAL_INPUTS
from ....shading.builder import Builder, Value, constant
from ..geometry.attributes import Attribute, AttributeSource
from ..geometry.instance_attributes import InstanceAttribute
from ..materials.nodes import color
from .links import Links, NodeKey, Path, Source

#: What is said of a node that is not known, with its label and the name of the input.
OWN_VALUE = "Materials whose {1} is given by a node '{0}' have the socket's own value"

#: The type of values by the type of Blender's sockets.
TYPES = {"VALUE": "float", "INT": "float", "BOOLEAN": "float", "VECTOR": "vec3", "RGBA": "vec3"}


class Ray(Enum):
    """A type of rays that find a surface."""

    CAMERA = "Is Camera Ray"
    SHADOW = "Is Shadow Ray"
    LIGHT = ""  # to a light: no output of Light Path tells, as in Cycles


class Closure(NamedTuple):
    """One shader of a surface, with the weight that mixing has given to it."""

    name: str
    weight: Value  # a number
    inputs: Mapping[str, Value]
    node: Any  # bpy.types.Node; None: Cycles' own


#: Name of the closures of nodes that are not known.
UNKNOWN = "unknown"
BASE_COLOR = MATERIAL_INPUTS["base_color"]

#: What a socket has: a value, or the closures of a shader.
Content = Value | list[Closure]
#: A value in place of another, or what makes it if it is needed: it may have meshes read an attribute.
Default = Value | Callable[[], Value]


def made(default: Default) -> Value:
    """The value itself."""
    return default if isinstance(default, Value) else default()


@dataclass
class NodeView:
    """A node to be converted: its inputs as values."""

    reader: "GraphReader"
    path: Path
    node: Any

    @property
    def builder(self) -> Builder:
        """Of the graph."""
        return self.reader.builder

    def socket(self, key: str | int) -> bpy.types.NodeSocket | None:
        """An input by its index, identifier or name; None if this release has none."""
        inputs = self.node.inputs
        if isinstance(key, int):
            return inputs[key] if key < len(inputs) else None
        return next((each for each in inputs if each.identifier == key), None) or inputs.get(key)

    def value(self, key: str | int, default: Default | None = None, note: str = OWN_VALUE) -> Value:
        """The value of an input; 0 if this release has none.

        The default, if there is one, is the value of an input that is not linked, or whose node is not known. The note
        is said of such a node, whose label it has in place of {}.
        """
        socket = self.socket(key)
        return constant(0.0) if socket is None else self.reader.value(self.path, socket, default, note)

    def is_used(self, output: str) -> bool:
        """Whether anything is linked to an output, by its identifier."""
        return any(each.is_linked for each in self.node.outputs if each.identifier == output)

    def closures(self, key: str | int) -> list[Closure]:
        """The closures of a shader's input."""
        socket = self.socket(key)
        return [] if socket is None else self.reader.closures(self.path, socket)

    def call(self, name: str, *operands: Value, parameter: int = 0) -> Value:
        """See Builder.call."""
        return self.builder.call(name, *operands, parameter=parameter)


#: Converts a node to the contents of its outputs, by their identifiers or names.
Converter = Callable[[NodeView], Mapping[str, Content]]


class GraphReader:
    """Reads the values and closures of sockets."""

    def __init__(
        self,
        converters: Mapping[str, Converter],
        material: bpy.types.Material | bpy.types.World,
        known_attributes: dict[InstanceAttribute, int],
        image: Callable[[Any], int],
        luminance: np.ndarray,
        simplify: bool,
    ):
        """`known_attributes`: of instances, with their indices in all graphs; those that are read are added.

        `image` gives the index of a node's image, or -1. `luminance` (3,): of the working space's primaries.
        """
        self.builder = Builder(simplify)
        self.material = material
        #: The rays that find the surface, and whether anything that has been read depends on that.
        self.ray, self.depends_on_ray = Ray.CAMERA, False
        #: The UV layer that the graph reads; "": the one that renders.
        self.uv_layer: str | None = None
        #: What else it reads of meshes.
        self.attributes: list[Attribute] = []
        #: What it reads of instances, in the order of reading.
        self.instance_attributes: dict[InstanceAttribute, None] = {}
        #: The normal of the surface if displacement changes it.
        self.displaced_normal: Value | None = None
        self._image, self._known_attributes = image, known_attributes
        self._converters, self._links = converters, Links()
        self._luminance = constant(luminance)
        self._contents: dict[tuple[NodeKey, str], Content] = {}
        self._converted: set[NodeKey] = set()

    def normal(self) -> Value:
        """The normal of a surface whose shaders have no other one."""
        return self.builder.call("geometry_normal") if self.displaced_normal is None else self.displaced_normal

    def surface(self, output: bpy.types.Node | None, ray: Ray = Ray.CAMERA) -> list[Closure]:
        """The closures of the surface of a material's output node, for such rays."""
        if output is None:
            return []
        if ray is not self.ray:
            self.ray = ray
            self._contents.clear()
            self._converted.clear()
        self.convert(output.inputs["Surface"])
        return self.closures((), output.inputs["Surface"])

    def convert(self, socket: bpy.types.NodeSocket) -> None:
        """Convert all nodes that an input outside of groups depends on: `value` and `closures` are then known."""
        for path, node in self._links.upstream((), socket):
            key = NodeKey.of(path, node)
            converter = self._converters.get(node.bl_idname)
            if key in self._converted or converter is None:
                continue
            self._converted.add(key)
            for name, content in converter(NodeView(self, path, node)).items():
                self._contents[key, name] = content

    def value(
        self, path: Path, socket: bpy.types.NodeSocket, default: Default | None = None, note: str = OWN_VALUE
    ) -> Value:
        """The value of an input, of the type that sockets of its type have. `default` and `note`: see NodeView."""
        found = self._links.source(path, socket)
        if default is not None and not found.is_linked:
            return made(default)
        value: Content | None = self._content(found) if found.is_linked else self.own_value(found.socket)
        if not isinstance(value, Value):
            fallback = self.own_value(socket) if default is None else made(default)
            return self.builder.substitute(fallback, note.format(found.socket.node.bl_label, socket.name))
        for source_type, type_ in pairwise(found.types):
            value = self._converted_value(value, source_type, type_)
        return value

    def closures(self, path: Path, socket: bpy.types.NodeSocket) -> list[Closure]:
        """The closures of a shader's input. A node that is not known is a closure of that name."""
        found = self._links.source(path, socket)
        if not found.is_linked:
            return []
        content = self._content(found)
        return content if isinstance(content, list) else [Closure(UNKNOWN, constant(1.0), {}, found.socket.node)]

    def image(self, node: bpy.types.Node) -> Value | None:
        """A node's image as an operand; None if it has none that can be read."""
        index = self._image(node)
        return None if index < 0 else Value("image", constant=float(index))

    def uv(self, layer: str) -> Value:
        """The coordinates of a UV layer; "": the one that renders."""
        if self.uv_layer in (None, layer):
            self.uv_layer = layer
            return self.builder.call("uv_map")
        return self.builder.call("color_of", self.attribute(AttributeSource.UV, layer))

    def position(self) -> Value:
        """Where environments are evaluated: as in Cycles, at the position."""
        return self.builder.call("geometry_position")

    def generated(self) -> Value:
        """Generated coordinates."""
        return self.builder.call("color_of", self.attribute(AttributeSource.GENERATED))

    def attribute(self, origin: AttributeSource, name: str = "") -> Value:
        """Four numbers of an attribute of meshes."""
        attribute = Attribute(origin, name)
        if attribute not in self.attributes:
            self.attributes.append(attribute)
        return self.builder.call("mesh_attribute", parameter=self.attributes.index(attribute))

    def instance_attribute(self, attribute: InstanceAttribute) -> Value:
        """Four numbers of an attribute of instances."""
        self.instance_attributes[attribute] = None
        index = self._known_attributes.setdefault(attribute, len(self._known_attributes))
        return self.builder.call("instance_attribute", parameter=index)

    def own_value(self, socket: bpy.types.NodeSocket) -> Value:
        """The value of a socket that is not linked."""
        type_ = TYPES.get(socket.type)
        if type_ is None:
            return constant(0.0)
        own: Any = getattr(socket, "default_value", 0.0 if type_ == "float" else (0.0, 0.0, 0.0))
        if type_ == "float":
            return constant(float(own))
        is_base_color = socket.name == BASE_COLOR.sockets.get(socket.node.bl_idname)
        return constant(color(own, BASE_COLOR.default if is_base_color else 0.0))

    def luminance_of(self, color: Value) -> Value:
        """The luminance of a color."""
        return self.builder.call("vector_dot_product", color, self._luminance)

    def _converted_value(self, value: Value, source_type: str, type_: str) -> Value:
        """The value of a socket of one type as that of a socket of another."""
        wanted = TYPES.get(type_, value.type)
        if value.type == wanted:
            return value
        if wanted == "vec3":
            return self.builder.call("grey", value)
        if source_type == "RGBA":
            return self.luminance_of(value)
        return self.builder.call("average", value)

    def _content(self, found: Source) -> Content | None:
        """What an output has; None if it is not known."""
        key = NodeKey.of(found.path, found.socket.node)
        names = found.socket.identifier, found.socket.name
        return next((self._contents[key, name] for name in names if (key, name) in self._contents), None)
