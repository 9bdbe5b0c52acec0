# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations of textures that are computed: Noise, White Noise, Voronoi and Gabor. They have no references.

Each is evaluated at four numbers, of which those beyond its dimensions are 0. The number of dimensions and other
options are the parameter, or in the name: a shader has only what they need.
"""

from .operations import OPERATIONS, Operation, set_cost

#: Types of noise with about their means, for Blender's offset and gain.
NOISE_MEANS = {
    "fbm": 0.0,
    "fbm_normalized": 0.5,
    "multifractal": 1.0,
    "hetero_terrain": 0.0,
    "hybrid_multifractal": 0.0,
    "ridged_multifractal": 0.1,
}
#: How distances are measured, in the order of voronoi_points.glsl.
METRICS = "EUCLIDEAN", "MANHATTAN", "CHEBYCHEV", "MINKOWSKI"
#: About the mean of textures within 0 and 1.
MIDDLE = 0.5
#: Numbers of a type, as operands.
FIVE = "float float float float float"


def texture(file: str, operands: str, result: str, *names: str, parameter: bool = True, mean: float = MIDDLE) -> None:
    """Register operations whose first operand is the point, and whose parameter has its number of dimensions."""
    types = tuple(operands.split())
    OPERATIONS.update(
        {name: Operation(types, result, f"procedural/{file}", has_parameter=parameter, mean=mean) for name in names}
    )


def voronoi_options(dimensions: int, metric: str, is_normalized: bool, has_integer_hash: bool) -> int:
    """The parameter of Voronoi textures, whose bits voronoi_cells.glsl reads."""
    return dimensions | METRICS.index(metric) << 3 | is_normalized << 5 | has_integer_hash << 6


# A vector, a fourth number and the scale of both.
texture("texture_point", "vec3 float float", "vec4", "texture_point", mean=0.0)
texture("white_noise", "vec4", "float", "white_noise")
texture("white_noise", "vec4", "vec3", "white_noise_color")
texture("noise", "vec4 float", "vec4", "noise_distorted", mean=0.0)
for type_, type_mean in NOISE_MEANS.items():
    # Detail, roughness, lacunarity, offset and gain.
    texture("noise", f"vec4 {FIVE}", "float", f"noise_{type_}", mean=type_mean)
    texture("noise", f"vec4 {FIVE}", "vec3", f"noise_{type_}_color", mean=type_mean)
# Detail, roughness, lacunarity, exponent and randomness, and smoothness.
texture("voronoi_points", f"vec4 {FIVE}", "Voronoi", "voronoi_f1", "voronoi_f2")
texture("voronoi_points", f"vec4 {FIVE} float", "Voronoi", "voronoi_smooth_f1")
texture("voronoi_points", "Voronoi", "float", "voronoi_distance", parameter=False)
texture("voronoi_points", "Voronoi", "vec3", "voronoi_color", parameter=False)
texture("voronoi_points", "Voronoi", "vec4", "voronoi_position", mean=0.0)
texture("voronoi_edges", "vec4 float float float float", "float", "voronoi_distance_to_edge")
texture("voronoi_edges", "vec4 float", "float", "voronoi_n_sphere_radius")
# Frequency, anisotropy and orientation.
texture("gabor", "vec4 float float float", "vec3", "gabor_2d", parameter=False)
texture("gabor", "vec4 float float vec3", "vec3", "gabor_3d", parameter=False)

# Measured with Mesa's software driver.
set_cost(12, "noise_distorted", *(f"noise_{type_}" for type_ in NOISE_MEANS))
set_cost(24, *(f"noise_{type_}_color" for type_ in NOISE_MEANS))
set_cost(60, *(f"voronoi_{feature}" for feature in ("f1", "f2", "smooth_f1", "distance_to_edge", "n_sphere_radius")))
set_cost(40, "gabor_2d", "gabor_3d")
