# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts nodes of worlds that give something else there than on surfaces: directions, in place of points.

As in Cycles, whose surface of a world has no object, the position in a direction is the direction itself.
"""

from collections.abc import Callable, Mapping

import bpy
import numpy as np

from ....shading.builder import Value, constant
from ..geometry.attributes import AttributeSource
from ..geometry.instance_attributes import InstanceAttribute
from ..node_graphs import shader_nodes
from ..node_graphs.converters import CONVERTERS
from ..node_graphs.links import Path
from ..node_graphs.reader import OWN_VALUE, Converter, Default, GraphReader, NodeView
from ..node_graphs.texture_nodes import placed

ZERO, ORIGIN, BACKWARDS = constant(0.0), constant((0.0, 0.0, 0.0)), constant(-1.0)

#: What is said of a node that is not known, see OWN_VALUE.
NOTE = "Worlds whose {1} is given by a node '{0}' have the socket's own value"

#: Nodes that depend on a mesh or its object, which a world has not.
OF_MESHES = {
    *("ShaderNodeTangent", "ShaderNodeNormalMap", "ShaderNodeBump", "ShaderNodeVectorTransform"),
    *("ShaderNodeAttribute", "ShaderNodeVertexColor", "ShaderNodeObjectInfo", "ShaderNodeUVMap"),
    "ShaderNodeAmbientOcclusion",
}


class WorldGraphReader(GraphReader):
    """Reads the values and closures of a world's sockets."""

    #: Makes the image of a Sky Texture, and gives its index.
    sky: Callable[[bpy.types.ShaderNodeTexSky], int]

    def position(self) -> Value:
        """The direction from the camera, or to the light."""
        return self.builder.call("world_direction")

    def normal(self) -> Value:
        """That of the world faces the camera."""
        return self.builder.call("vector_scale", self.position(), BACKWARDS)

    def uv(self, layer: str) -> Value:
        """The origin, as in Cycles."""
        return ORIGIN

    def generated(self) -> Value:
        """The direction."""
        return self.position()

    def attribute(self, origin: AttributeSource, name: str = "") -> Value:
        """A world has no attributes of meshes."""
        return constant((0.0, 0.0, 0.0, 0.0))

    def instance_attribute(self, attribute: InstanceAttribute) -> Value:
        """Nor of instances."""
        return constant((0.0, 0.0, 0.0, 0.0))

    def value(
        self, path: Path, socket: bpy.types.NodeSocket, default: Default | None = None, note: str = OWN_VALUE
    ) -> Value:
        """See GraphReader.value."""
        return super().value(path, socket, default, NOTE if note is OWN_VALUE else note)


def texture_coordinate(view: NodeView) -> Mapping[str, Value]:
    """Texture Coordinate."""
    direction, other = view.reader.position(), view.node.object
    outputs = {
        "Generated": direction,
        "Normal": view.reader.normal(),
        "UV": ORIGIN,
        "Object": direction,
        "Camera": view.call("camera_from_world_vector", direction),
        "Window": view.call("world_window"),
        "Reflection": view.reader.normal(),
    }
    if other is not None:
        rows = np.array(other.matrix_world.inverted_safe())[:3]
        turned = (view.call("vector_dot_product", direction, constant(row[:3])) for row in rows)
        outputs["Object"] = view.call("vector_add", view.call("combine_xyz", *turned), constant(rows[:, 3]))
    return outputs


def geometry(view: NodeView) -> Mapping[str, Value]:
    """Geometry."""
    normal = view.reader.normal()
    return {
        "Position": view.reader.position(),
        "Normal": normal,
        "Tangent": ORIGIN,
        "True Normal": normal,
        "Incoming": normal,
        "Parametric": ORIGIN,
        "Backfacing": ZERO,
        "Pointiness": ZERO,
        "Random Per Island": ZERO,
    }


def camera_data(view: NodeView) -> Mapping[str, Value]:
    """Camera Data."""
    vector = view.call("camera_from_world_vector", view.reader.position())
    names = ("vector_normalize", "separate_z", "vector_length")
    return dict(
        zip(("View Vector", "View Z Depth", "View Distance"), (view.call(n, vector) for n in names), strict=True)
    )


def light_path(view: NodeView) -> Mapping[str, Value]:
    """Light Path. The world has no distance."""
    view.reader.depends_on_ray = True
    outputs = {socket.name: ZERO for socket in view.node.outputs}
    return outputs | ({view.reader.ray.value: constant(1.0)} if view.reader.ray.value else {})


def sky_texture(view: NodeView) -> Mapping[str, Value]:
    """Sky Texture, without its sun: that is a light."""
    assert isinstance(view.reader, WorldGraphReader)
    image = Value("image", constant=float(view.reader.sky(view.node)))
    is_placed = view.socket("Vector") is not None  # some models have no such input
    vector = placed(view, view.value("Vector", view.reader.position) if is_placed else view.reader.position())
    color = view.call("image_equirectangular", image, vector, parameter=0)
    return {"Color": view.call("color_of", color)}


WORLD_CONVERTERS: dict[str, Converter] = {
    **{name: converter for name, converter in CONVERTERS.items() if name not in OF_MESHES},
    "ShaderNodeBackground": shader_nodes.shader("emission", "Background", color="Color", strength="Strength"),
    "ShaderNodeTexCoord": texture_coordinate,
    "ShaderNodeNewGeometry": geometry,
    "ShaderNodeCameraData": camera_data,
    "ShaderNodeLightPath": light_path,
    "ShaderNodeTexSky": sky_texture,
}
