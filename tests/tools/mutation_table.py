# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors that mutations.py puts into the product."""

from typing import NamedTuple


class Mutation(NamedTuple):
    """A text that the package contains once, in any file, its replacement, and the test files that should notice it."""

    about: str
    old: str
    new: str
    tests: tuple[str, ...]  # names of files in any folder


MUTATIONS = (
    Mutation(
        "a Lambertian surface reflects pi times its light",
        "(INVERSE_PI * irradiance)",
        "irradiance",
        ("test_light_types", "test_picture"),
    ),
    Mutation(
        "shadow rays are weighed without the receiver's cosine",
        "(INVERSE_PI * max(dot(surface.normal, wi), 0.0))",
        "INVERSE_PI",
        ("test_trace_shadows", "test_ray_sampling"),
    ),
    Mutation("Lambert's edge sum has the other sign", "? sum : -sum", "? -sum : sum", ("test_irradiance",)),
    Mutation(
        "an ellipse is lit by its diameters as if they were semi-axes",
        "ellipse_irradiance(centre, 0.5 * u, 0.5 * v",
        "ellipse_irradiance(centre, u, v",
        ("test_irradiance", "test_picture"),
    ),
    Mutation(
        "samples of an area light are uniform in the coordinates of chords, which their density does not say",
        "uv.y = sample_linear(weights, uv.y);",
        "",
        ("test_light_interface",),
    ),
    Mutation(
        "a rare shadow ray counts no more than a frequent one",
        "direct_residual.rgb += correction / rate;",
        "direct_residual.rgb += correction;",
        ("test_trace_shadows", "test_picture"),
    ),
    Mutation(
        "the last light is not drawn",
        "for light in frame[CONTRIBUTING_LIGHTS]:",
        "for light in frame[CONTRIBUTING_LIGHTS][:-1]:",
        ("test_trace_shadows", "test_picture"),
    ),
    Mutation(
        "lights are culled that bring as much as all others",
        "culled > MAX_CULLED_FRACTION * local",
        "culled > local",
        ("test_cull_lights", "test_shortcuts"),
    ),
    Mutation(
        "the bound of a light forgets how large it is",
        "slack = radius + self.radius",
        "slack = radius",
        ("test_cull_lights", "test_shortcuts"),
    ),
    Mutation(
        "tiles are one off",
        "strip * int(gl_FragCoord.y) + int(gl_FragCoord.x);",
        "strip * int(gl_FragCoord.y) + int(gl_FragCoord.x) + 1;",
        ("test_cull_lights", "test_select_tiles", "test_predict_visibility"),
    ),
    Mutation(
        "another world leaves the picture as it was",
        '*(Change.WORLD, Change.VIEW, "ssao"),',
        '*(Change.VIEW, "ssao"),',
        ("test_edits", "test_reuse"),
    ),
    Mutation(
        "instances that moved are seen where they were",
        "inputs = MESH_BUFFERS, INSTANCE_BUFFERS, POINT_GRAPHS",
        "inputs = MESH_BUFFERS, POINT_GRAPHS",
        ("test_edits", "test_reuse"),
    ),
    Mutation(
        "pixels at a tile's border do not care how rare the tile beside them is",
        ".y / fetch(tile_probabilities, ivec2(tile)).x",
        ".y",
        ("test_accumulate", "test_select_tiles"),
    ),
    Mutation(
        "watts become radiance without pi",
        "/ (np.pi * area)",
        "/ area",
        ("test_radiometry", "test_lights"),
    ),
    Mutation(
        "a spread is taken for its half",
        "half = np.maximum(np.asarray(spread, np.float64), MIN_SPREAD) / 2.0",
        "half = np.maximum(np.asarray(spread, np.float64), MIN_SPREAD) / 4.0",
        ("test_radiometry", "test_irradiance"),
    ),
    Mutation(
        "lights stand in world space among surfaces in anchor space",
        'table["position"] = lights.position - anchor',
        'table["position"] = lights.position',
        ("test_odd_pictures", "test_spread_shadows"),
    ),
    Mutation(
        "normals are turned as positions are",
        "normalize(cofactor * smooth_normal)",
        "normalize(linear * smooth_normal)",
        ("test_gbuffer",),
    ),
    Mutation(
        "sRGB texels are taken for linear ones", "if (image.encoding == SRGB_BYTES)", "if (false)", ("test_images",)
    ),
    Mutation(
        "graphs read other constants",
        "differentials, material.first_constant)",
        "differentials, 0)",
        ("test_node_graphs",),
    ),
    Mutation("graphs draw other tiles", "uint(graph + 1 & 31);", "uint(graph + 2 & 31);", ("test_node_graphs",)),
    Mutation(
        "a box that is partly out of the picture is culled",
        "planes[..., 3] + np.einsum",
        "planes[..., 3] - np.einsum",
        ("test_frustum_culling", "test_gbuffer"),
    ),
    Mutation(
        "a chosen point does not stand for those that were not chosen",
        "np.sqrt(cloud.area / np.pi / probabilities[selected])",
        "np.sqrt(cloud.area / np.pi)",
        ("test_select_points", "test_splat"),
    ),
    Mutation(
        "a disc at a map's horizon is dropped where rounding takes its centre out of the map",
        "clamp(square_from_hemisphere(d), -1.0, 1.0)",
        "square_from_hemisphere(d)",
        ("test_splat",),
    ),
    Mutation("glass tints nothing", "DST_COLOR, moderngl.ZERO", "ZERO, moderngl.ONE", ("test_transparency",)),
    Mutation(
        "a transparent film is opaque",
        "mix(opaque, 1.0, film)",
        "1.0",
        ("test_shade", "test_engine"),
    ),
    Mutation(
        "the shadow bias pushes inwards",
        "v += n * (bias * texel_angle",
        "v -= n * (bias * texel_angle",
        ("test_gather", "test_picture"),
    ),
    Mutation(
        "outlines in shadow maps grow as holes are filled",
        "hole && coverage > 0.5",
        "hole && coverage > 0.0",
        ("test_fill_holes",),
    ),
    Mutation(
        "ambient occlusion looks twice as far as its radius",
        "direction * radius * sqrt(c.z)",
        "direction * 2.0 * radius * sqrt(c.z)",
        ("test_ambient_occlusion",),
    ),
    Mutation(
        "what lies behind a light throws a shadow",
        "if (hit.distance < end && next != ignored)",
        "if (hit.distance < 2.0 && next != ignored)",
        ("test_build_bvh", "test_trace_shadows"),
    ),
    Mutation(
        "edges of lamps are filtered to the wrong side",
        "vec2 offset = vec2(x, y) + visibility_texel_and_offset.zw",
        "vec2 offset = vec2(x, y) - visibility_texel_and_offset.zw",
        ("test_filter_emission",),
    ),
    Mutation(
        "a faint light's turns are rarer than they count",
        "unshadowed_diffuse(surface, light, irradiance, color) / tile_probability",
        "unshadowed_diffuse(surface, light, irradiance, color)",
        ("test_faint_lights",),
    ),
    Mutation(
        "renders with a large error have no more than the requested samples",
        "return MAX_REFINEMENT * quality.samples if expected > sufficient",
        "return quality.samples if expected > sufficient",
        ("test_ends",),
    ),
    Mutation(
        "the visibility of many lights is predicted anew however few draws follow",
        "return self.excess_lights == 1.0 or ",
        "return self.excess_lights >= 1.0 or ",
        ("test_select_tiles",),
    ),
    Mutation(
        "colors of no luminance are not worth a correction",
        "return dot(color * color, luminance_weights.rgb);",
        "return luminance(color) * luminance(color);",
        ("test_world_light",),
    ),
    Mutation(
        "rays in dark tiles are as rare as in bright ones",
        "deviation / (tile_tolerance * ray_threshold)",
        "deviation / ray_threshold",
        ("test_select_tiles",),
    ),
)
