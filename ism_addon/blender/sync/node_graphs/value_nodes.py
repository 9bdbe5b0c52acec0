# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts nodes of numbers and vectors."""

from collections.abc import Mapping

from ....shading.builder import Value, constant
from ....shading.operations import OPERATIONS
from .reader import Converter, NodeView

#: Names of Vector Math's operations that give a number.
TO_NUMBER = ("DOT_PRODUCT", "DISTANCE", "LENGTH")


def value(view: NodeView) -> Mapping[str, Value]:
    """Value."""
    return {"Value": constant(view.node.outputs[0].default_value)}


def rgb(view: NodeView) -> Mapping[str, Value]:
    """RGB."""
    return {"Color": constant(view.node.outputs[0].default_value[:3])}


def math(view: NodeView) -> Mapping[str, Value]:
    """Math."""
    name = f"math_{view.node.operation.lower()}"
    if name not in OPERATIONS:
        return {}
    result = view.call(name, *(view.value(k) for k in range(len(OPERATIONS[name].operands))))
    return {"Value": view.call("saturate", result) if view.node.use_clamp else result}


def vector_math(view: NodeView) -> Mapping[str, Value]:
    """Vector Math."""
    operation = view.node.operation
    name = f"vector_{operation.lower()}"
    if name not in OPERATIONS:
        return {}
    vectors = [view.value(k) for k in range(OPERATIONS[name].operands.count("vec3"))]
    scales = [view.value("Scale")] if "float" in OPERATIONS[name].operands else []
    return {"Value" if operation in TO_NUMBER else "Vector": view.call(name, *vectors, *scales)}


def clamp(view: NodeView) -> Mapping[str, Value]:
    """Clamp."""
    operands = (view.value(key) for key in ("Value", "Min", "Max"))
    return {"Result": view.call(f"clamp_{view.node.clamp_type.lower()}", *operands)}


def map_range(view: NodeView) -> Mapping[str, Value]:
    """Map Range of numbers and vectors."""
    node = view.node
    is_vector = node.data_type == "FLOAT_VECTOR"
    prefix, suffix, keys = "vector_" if is_vector else "", "_FLOAT3" if is_vector else "", ("From", "To")
    low, high, to_low, to_high = (
        view.value(f"{key}_{end}{suffix}" if is_vector else f"{key} {end}") for key in keys for end in (("Min", "Max"))
    )
    source = view.value("Vector" if is_vector else "Value")
    steps = [view.value(f"Steps{suffix}")] if node.interpolation_type == "STEPPED" else []
    fraction = view.call(f"{prefix}fraction_{node.interpolation_type.lower()}", source, low, high, *steps)
    if is_vector:
        result = view.call("mix_by_component", fraction, to_low, to_high)
    else:
        result = view.call("mix_float", fraction, to_low, to_high)
    if node.clamp and node.interpolation_type in ("LINEAR", "STEPPED"):
        result = view.call(f"{prefix}clamp_range", result, to_low, to_high)
    return {"Vector" if is_vector else "Result": result}


def mix(view: NodeView) -> Mapping[str, Value]:
    """Mix of numbers, vectors and colors."""
    node = view.node
    type_ = {"FLOAT": "Float", "VECTOR": "Vector", "RGBA": "Color"}.get(node.data_type)
    if type_ is None:
        return {}
    one, other, is_uniform = view.value(f"A_{type_}"), view.value(f"B_{type_}"), True
    if type_ == "Vector" and node.factor_mode == "NON_UNIFORM":
        factor, is_uniform = view.value("Factor_Vector"), False
    else:
        factor = view.value("Factor_Float")
    if node.clamp_factor:
        factor = view.call("saturate" if is_uniform else "vector_saturate", factor)
    if type_ == "Color":
        result = view.call(f"blend_{node.blend_type.lower()}", factor, one, other)
        if node.clamp_result:
            result = view.call("vector_saturate", result)
    elif type_ == "Vector":
        result = view.call("mix_vector" if is_uniform else "mix_by_component", factor, one, other)
    else:
        result = view.call("mix_float", factor, one, other)
    return {f"Result_{type_}": result}


def mapping(view: NodeView) -> Mapping[str, Value]:
    """Mapping."""
    vector, rotation, scale = (view.value(key) for key in ("Vector", "Rotation", "Scale"))
    type_ = view.node.vector_type.lower()
    location = view.value("Location") if type_ in ("point", "texture") else constant((0.0, 0.0, 0.0))
    return {"Vector": view.call(f"mapping_{type_}", vector, location, rotation, scale)}


def vector_rotate(view: NodeView) -> Mapping[str, Value]:
    """Vector Rotate."""
    node, vector, centre = view.node, view.value("Vector"), view.value("Center")
    if node.rotation_type == "EULER_XYZ":
        name = "rotate_euler_inverse" if node.invert else "rotate_euler"
        return {"Vector": view.call(name, vector, centre, view.value("Rotation"))}
    axes = {"X_AXIS": (1.0, 0.0, 0.0), "Y_AXIS": (0.0, 1.0, 0.0), "Z_AXIS": (0.0, 0.0, 1.0)}
    axis = constant(axes[node.rotation_type]) if node.rotation_type in axes else view.value("Axis")
    angle = view.value("Angle")
    if node.invert:
        angle = view.call("math_multiply", angle, constant(-1.0))
    return {"Vector": view.call("rotate_axis", vector, centre, axis, angle)}


def combine_xyz(view: NodeView) -> Mapping[str, Value]:
    """Combine XYZ."""
    return {"Vector": view.call("combine_xyz", *(view.value(k) for k in range(3)))}


def separate_xyz(view: NodeView) -> Mapping[str, Value]:
    """Separate XYZ."""
    vector = view.value("Vector")
    return {axis.upper(): view.call(f"separate_{axis}", vector) for axis in "xyz"}


CONVERTERS: dict[str, Converter] = {
    "ShaderNodeValue": value,
    "ShaderNodeRGB": rgb,
    "ShaderNodeMath": math,
    "ShaderNodeVectorMath": vector_math,
    "ShaderNodeClamp": clamp,
    "ShaderNodeMapRange": map_range,
    "ShaderNodeMix": mix,
    "ShaderNodeMapping": mapping,
    "ShaderNodeVectorRotate": vector_rotate,
    "ShaderNodeCombineXYZ": combine_xyz,
    "ShaderNodeSeparateXYZ": separate_xyz,
}
