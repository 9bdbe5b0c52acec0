# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations that depend on the point of a surface: they have no references."""

from .operations import OPERATIONS, Operation

#: What is beyond an image's border, as Blender names it, in the order of textures/image.glsl.
EXTENSIONS = "REPEAT", "EXTEND", "CLIP", "MIRROR"

#: How images are interpolated.
INTERPOLATIONS = "linear", "closest", "cubic"

#: What the node Vector Transform transforms.
VECTOR_TYPES = "point", "vector", "normal"


def at_point(
    file: str,
    result: str,
    *names: str,
    operands: str = "",
    parameter: bool = False,
    unfiltered: tuple[int, ...] = (),
    mean: float = 0.0,
) -> None:
    """Register operations that depend on the point. `operands`: types separated by spaces."""
    types = tuple(operands.split())
    operation = Operation(types, result, file, at_point=True, has_parameter=parameter, unfiltered=unfiltered, mean=mean)
    OPERATIONS.update(dict.fromkeys(names, operation))


at_point("point", "vec3", "uv_map")
at_point("point", "vec4", "mesh_attribute", parameter=True)  # the index among the material's attributes
at_point(
    "point_inputs",
    "vec3",
    *(f"geometry_{name}" for name in ("position", "normal", "true_normal", "incoming", "parametric")),
    *(f"coordinate_{name}" for name in ("reflection", "camera", "window")),
)
at_point("point_inputs", "float", "geometry_backfacing", "ray_length")
at_point("world", "vec3", "world_direction", "world_window")
at_point("point_inputs", "float", "fresnel", "layer_weight_fresnel", operands="float vec3", mean=0.1)
at_point("point_inputs", "float", "layer_weight_facing", operands="float vec3", mean=0.3)
# The maximum of the distance, and the normal. The parameter is twice the number of rays, and 1 more if they go inside.
at_point("occlusion", "float", "ambient_occlusion", operands="float vec3", parameter=True, mean=1.0)
at_point("object", "vec3", "coordinate_object", "coordinate_normal", "object_location")
at_point("object", "vec4", "object_color")
at_point("object", "float", "object_index", "object_random")
at_point("instance_attributes", "vec4", "instance_attribute", parameter=True)  # the index in Instances.attributes
at_point("point_inputs", "vec3", "coordinate_of_object", operands="vec4 vec4 vec4")  # rows of a matrix
at_point("object", "vec3", *(f"object_from_world_{vector_type}" for vector_type in VECTOR_TYPES), operands="vec3")
at_point("object", "vec3", "world_from_object_point", "world_from_object_vector", operands="vec3")
at_point("normals", "vec3", "world_from_object_normal", "surface_tangent", "reflecting_normal", operands="vec3")
at_point("normals", "vec3", "normal_map_tangent", operands="float vec3 vec4", unfiltered=(1,))
at_point("normals", "vec3", "normal_map_object", "normal_map_world", operands="float vec3", unfiltered=(1,))
OPERATIONS.update(
    {
        f"{name}_{vector_type}": Operation(("vec3",), "vec3", "point_inputs")
        for name in ("camera_from_world", "world_from_camera")
        for vector_type in VECTOR_TYPES
    }
)
OPERATIONS.update(
    {
        # The parameter is what is beyond the border, an index of EXTENSIONS.
        f"image_{interpolation}": Operation(
            ("image", "vec3"), "vec4", "images/image", has_parameter=True, with_differences=(1,)
        )
        for interpolation in INTERPOLATIONS
    }
)
OPERATIONS.update(
    {
        # The parameter is the interpolation and what is beyond the border, as in nodes/images/image.glsl.
        name: Operation(("image", "vec3"), "vec4", "images/environment", has_parameter=True, with_differences=(1,))
        for name in ("image_equirectangular", "image_mirror_ball")
    }
)
# Strength and distance, the height, the position, the normal that is changed, and the filter's width in pixels.
OPERATIONS["bump"] = Operation(
    ("float", "float", "float", "vec3", "vec3", "float"),
    "vec3",
    "normals",
    with_differences=(2, 3),
    filter_width=5,
    unfiltered=(2, 3),
)
