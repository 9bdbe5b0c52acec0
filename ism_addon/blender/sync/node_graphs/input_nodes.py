# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts nodes that give what is known of a point: its surface, its object and the camera."""

from collections.abc import Mapping

from ....shading.builder import Value, constant
from ..geometry.attributes import AttributeSource
from ..geometry.instance_attributes import InstanceAttribute
from .pattern_nodes import radial_tangent
from .reader import Converter, NodeView

ZERO, ONE = constant(0.0), constant(1.0)

#: Rays that a node Ambient Occlusion traces in each sample of a pixel.
MAX_RAYS = 4

#: Outputs of the nodes Camera Data and Light Path.
CAMERA_DATA = "View Vector", "View Z Depth", "View Distance"


def attribute(view: NodeView) -> Mapping[str, Value]:
    """Attribute of the mesh, of the object, of its instancer or of the view layer."""
    node, outputs = view.node, {}
    if node.attribute_type != "GEOMETRY":
        numbers = view.reader.instance_attribute(InstanceAttribute(node.attribute_type, node.attribute_name))
        outputs = color_and_alpha(view, numbers)
        return {**outputs, "Vector": outputs["Color"], "Fac": view.call("average", outputs["Color"])}
    if view.is_used("Fac"):
        number = view.reader.attribute(AttributeSource.NUMBER, node.attribute_name)
        outputs["Fac"] = view.call("separate_x", view.call("color_of", number))
    if any(map(view.is_used, ("Color", "Vector", "Alpha"))):
        numbers = view.reader.attribute(AttributeSource.NAMED, node.attribute_name)
        outputs |= color_and_alpha(view, numbers)
        outputs["Vector"] = outputs["Color"]
    return outputs


def color_attribute(view: NodeView) -> Mapping[str, Value]:
    """Color Attribute."""
    return color_and_alpha(view, view.reader.attribute(AttributeSource.COLOR, view.node.layer_name))


def color_and_alpha(view: NodeView, numbers: Value) -> dict[str, Value]:
    """Two outputs of four numbers."""
    return {"Color": view.call("color_of", numbers), "Alpha": view.call("alpha_of", numbers)}


def geometry(view: NodeView) -> Mapping[str, Value]:
    """Geometry."""
    names = {
        "Position": "position",
        "Normal": "normal",
        "True Normal": "true_normal",
        "Incoming": "incoming",
        "Parametric": "parametric",
        "Backfacing": "backfacing",
    }
    outputs = {output: view.call(f"geometry_{name}") for output, name in names.items()}
    if view.is_used("Tangent"):
        outputs["Tangent"] = radial_tangent(view, "Z")
    return outputs


def object_info(view: NodeView) -> Mapping[str, Value]:
    """Object Info."""
    return {
        "Location": view.call("object_location"),
        **color_and_alpha(view, view.call("object_color")),
        "Object Index": view.call("object_index"),
        "Material Index": constant(float(view.reader.material.pass_index)),
        "Random": view.call("object_random"),
    }


def camera_data(view: NodeView) -> Mapping[str, Value]:
    """Camera Data."""
    vector = view.call("coordinate_camera")
    values = (view.call(name, vector) for name in ("vector_normalize", "separate_z", "vector_length"))
    return dict(zip(CAMERA_DATA, values, strict=True))


def normal_of(view: NodeView) -> Value:
    """A node's Normal input, or that of the surface."""
    return view.value("Normal", view.reader.normal())


def fresnel(view: NodeView) -> Mapping[str, Value]:
    """Fresnel."""
    return {"Fac": view.call("fresnel", view.value("IOR"), normal_of(view))}


def layer_weight(view: NodeView) -> Mapping[str, Value]:
    """Layer Weight."""
    blend, normal = view.value("Blend"), normal_of(view)
    return {name: view.call(f"layer_weight_{name.lower()}", blend, normal) for name in ("Fresnel", "Facing")}


def light_path(view: NodeView) -> Mapping[str, Value]:
    """Light Path of what the camera sees, and of shadow rays."""
    view.reader.depends_on_ray = True
    outputs = {socket.name: ZERO for socket in view.node.outputs}
    return outputs | {view.reader.ray.value: ONE, "Ray Length": view.call("ray_length")}


def ambient_occlusion(view: NodeView) -> Mapping[str, Value]:
    """Ambient Occlusion. Its rays are spread over the samples of a pixel."""
    rays = 2 * min(max(view.node.samples, 1), MAX_RAYS) + int(view.node.inside)
    openness = view.call("ambient_occlusion", view.value("Distance"), normal_of(view), parameter=rays)
    if view.node.only_local:
        note = "Ambient Occlusion nodes of Only Local see all objects"
        openness = view.builder.substitute(openness, note)
    return {"Color": view.call("vector_scale", view.value("Color"), openness), "AO": openness}


CONVERTERS: dict[str, Converter] = {
    "ShaderNodeAmbientOcclusion": ambient_occlusion,
    "ShaderNodeAttribute": attribute,
    "ShaderNodeVertexColor": color_attribute,
    "ShaderNodeNewGeometry": geometry,
    "ShaderNodeObjectInfo": object_info,
    "ShaderNodeCameraData": camera_data,
    "ShaderNodeFresnel": fresnel,
    "ShaderNodeLayerWeight": layer_weight,
    "ShaderNodeLightPath": light_path,
}
