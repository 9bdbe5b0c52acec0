# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts textures and the nodes that place them."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from ....shading.builder import Value, constant
from ....shading.inputs import EXTENSIONS
from .reader import Converter, NodeView

#: Blender's colour of images that are missing.
MAGENTA = constant((1.0, 0.0, 1.0))

#: Operations by Blender's interpolations.
INTERPOLATIONS = {"Linear": "image_linear", "Closest": "image_closest", "Cubic": "image_cubic", "Smart": "image_cubic"}


def uv_map(view: NodeView) -> Mapping[str, Value]:
    """UV Map."""
    return {"UV": view.reader.uv(view.node.uv_map)}


def texture_coordinate(view: NodeView) -> Mapping[str, Value]:
    """Texture Coordinate. Those of another object, and of what makes instances, are not known."""
    outputs = {name: view.call(f"coordinate_{name.lower()}") for name in ("Normal", "Camera", "Window", "Reflection")}
    if view.is_used("UV") and not view.node.from_instancer:
        outputs["UV"] = view.reader.uv("")
    if view.is_used("Generated") and not view.node.from_instancer:
        outputs["Generated"] = view.reader.generated()
    if view.node.object is None:
        outputs["Object"] = view.call("coordinate_object")
    return outputs


def placed(view: NodeView, vector: Value) -> Value:
    """A vector as the node's own mapping changes it, which old files have."""
    own = view.node.texture_mapping
    is_identity = not any(own.translation) and not any(own.rotation) and tuple(own.scale) == (1.0, 1.0, 1.0)
    axes = np.zeros((3, 3))
    for row, axis in enumerate((own.mapping_x, own.mapping_y, own.mapping_z)):
        if axis != "NONE":
            axes[row, "XYZ".index(axis)] = 1.0
    if not np.array_equal(axes, np.eye(3)):
        rows = [view.call("vector_dot_product", vector, constant(row)) for row in axes]
        vector = view.call("combine_xyz", *rows)
    if not is_identity:
        location, rotation, scale = (constant(tuple(each)) for each in (own.translation, own.rotation, own.scale))
        vector = view.call(f"mapping_{own.vector_type.lower()}", vector, location, rotation, scale)
    if own.use_min:
        vector = view.call("vector_maximum", vector, constant(tuple(own.min)))
    if own.use_max:
        vector = view.call("vector_minimum", vector, constant(tuple(own.max)))
    return vector


def image_texture(view: NodeView) -> Mapping[str, Value]:
    """Image Texture."""
    node, image = view.node, view.reader.image(view.node)
    if image is None:
        return {"Color": MAGENTA, "Alpha": constant(1.0)}
    note = "Textures placed by a node '{}' lie on the active UV map as it is"
    vector = view.value("Vector", partial(view.reader.uv, ""), note)
    operation = INTERPOLATIONS[node.interpolation]
    extension = EXTENSIONS.index(node.extension)
    color = view.call(operation, image, placed(view, vector), parameter=extension)
    return {"Color": view.call("color_of", color), "Alpha": view.call("alpha_of", color)}


CONVERTERS: dict[str, Converter] = {
    "ShaderNodeUVMap": uv_map,
    "ShaderNodeTexCoord": texture_coordinate,
    "ShaderNodeTexImage": image_texture,
}
