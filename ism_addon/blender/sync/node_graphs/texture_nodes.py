# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts textures and the nodes that place them."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from ....shading.builder import Value, constant
from ....shading.inputs import EXTENSIONS, INTERPOLATIONS
from .reader import Converter, NodeView

#: Blender's colour of images that are missing.
MAGENTA = constant((1.0, 0.0, 1.0))

#: Names of interpolations in operations, by Blender's.
INTERPOLATED = {"Linear": "linear", "Closest": "closest", "Cubic": "cubic", "Smart": "cubic"}


def uv_map(view: NodeView) -> Mapping[str, Value]:
    """UV Map."""
    return {"UV": view.reader.uv(view.node.uv_map)}


def texture_coordinate(view: NodeView) -> Mapping[str, Value]:
    """Texture Coordinate. Those of what makes instances are not known."""
    outputs = {name: view.call(f"coordinate_{name.lower()}") for name in ("Normal", "Camera", "Window", "Reflection")}
    if view.is_used("UV") and not view.node.from_instancer:
        outputs["UV"] = view.reader.uv("")
    if view.is_used("Generated") and not view.node.from_instancer:
        outputs["Generated"] = view.reader.generated()
    other = view.node.object
    if other is None:
        outputs["Object"] = view.call("coordinate_object")
    else:
        rows = np.array(other.matrix_world.inverted_safe())[:3]
        outputs["Object"] = view.call("coordinate_of_object", *map(constant, rows))
    return outputs


def placed(view: NodeView, vector: Value) -> Value:
    """A vector as the node's own mapping changes it, which old files have. As in Cycles, its limits have no effect."""
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
    return vector


def texture_vector(view: NodeView) -> Value:
    """Where a procedural texture is evaluated."""
    note = "Textures placed by a node '{}' lie on generated coordinates"
    return placed(view, view.value("Vector", view.reader.generated, note))


def image_texture(view: NodeView) -> Mapping[str, Value]:
    """Image Texture."""
    node, image = view.node, view.reader.image(view.node)
    if image is None:
        return {"Color": MAGENTA, "Alpha": constant(1.0)}
    note = "Textures placed by a node '{}' lie on the active UV map as it is"
    vector = placed(view, view.value("Vector", partial(view.reader.uv, ""), note))
    interpolation = INTERPOLATED[node.interpolation]
    blend = [constant(node.projection_blend)] if node.projection == "BOX" else []
    extension = EXTENSIONS.index(node.extension)
    if node.projection == "FLAT":
        color = view.call(f"image_{interpolation}", image, vector, parameter=extension)
    else:
        sampling = INTERPOLATIONS.index(interpolation) * len(EXTENSIONS) + extension
        color = view.call(f"image_{node.projection.lower()}", image, *blend, vector, parameter=sampling)
    return {"Color": view.call("color_of", color), "Alpha": view.call("alpha_of", color)}


def environment_texture(view: NodeView) -> Mapping[str, Value]:
    """Environment Texture."""
    node, image = view.node, view.reader.image(view.node)
    if image is None:
        return {"Color": MAGENTA}
    vector = placed(
        view, view.value("Vector", view.reader.position, "Environments placed by a node '{}' are not moved")
    )
    sampling = INTERPOLATIONS.index(INTERPOLATED[node.interpolation]) * len(EXTENSIONS)
    color = view.call(f"image_{node.projection.lower()}", image, vector, parameter=sampling)
    return {"Color": view.call("color_of", color)}


CONVERTERS: dict[str, Converter] = {
    "ShaderNodeTexEnvironment": environment_texture,
    "ShaderNodeUVMap": uv_map,
    "ShaderNodeTexCoord": texture_coordinate,
    "ShaderNodeTexImage": image_texture,
}
