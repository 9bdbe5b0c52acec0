# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations that add shaders to the closures of a surface, and what such shaders leave to those below them.

Weights are colors, as the layers above can be tinted. The functions are in gpu/glsl/nodes/closures.glsl and gloss.glsl.
"""

from .operations import OPERATIONS, Operation

#: Operations that add a lobe of microfacets, that change those, and that add others than Lambert's.
GLOSSY = "closure_glossy", "closure_metal", "closure_dielectric"
COAT = ("closure_coat",)
EXTRA = "closure_anisotropy", "closure_sheen", "closure_rough_diffuse"

#: Operations that do not end with the normal.
WITHOUT_NORMAL = "closure_transparent", "closure_emission"


def closure(file: str, operands: str, *names: str, parameter: bool = False, cost: int = 1) -> None:
    """Register operations that add to the closures at a point. `operands`: types separated by spaces."""
    types = tuple(operands.split())
    OPERATIONS.update(
        {name: Operation(types, "", file, at_point=True, has_parameter=parameter, cost=cost) for name in names}
    )


# What passes, and what is emitted.
closure("closures", "vec3", "closure_transparent", "closure_emission")
# What is reflected, and the normal.
closure("closures", "vec3 vec3", "closure_diffuse")
# Weight, color, roughness and normal.
closure("closures", "vec3 vec3 float vec3", "closure_rough_diffuse")
# Weight, color, roughness and normal. The parameter: 1 if light is reflected between microfacets more than once.
closure("gloss", "vec3 vec3 float vec3", "closure_glossy", parameter=True, cost=4)
# Weight, color, tint at grazing angles, roughness and normal.
closure("gloss", "vec3 vec3 vec3 float vec3", "closure_metal", parameter=True, cost=6)
# Weight, index of refraction, its level, tint, roughness and normal.
closure("gloss", "vec3 float float vec3 float vec3", "closure_dielectric", parameter=True, cost=8)
# The same, of what is below a dielectric's lobe.
OPERATIONS["below_dielectric"] = Operation(
    ("vec3", "float", "float", "vec3", "float", "vec3"),
    "vec3",
    "gloss",
    at_point=True,
    has_parameter=True,
    cost=4,
    mean=1.0,
)
# Anisotropy, rotation, tangent and normal: of all glossy lobes but the coat.
closure("gloss", "float float vec3 vec3", "closure_anisotropy")
# Weight, index of refraction, roughness and normal.
closure("gloss", "vec3 float float vec3", "closure_coat", parameter=True, cost=4)
# The weight of what is below, the coat's weight, index of refraction, roughness, tint and normal.
OPERATIONS["below_coat"] = Operation(
    ("vec3", "float", "float", "float", "vec3", "vec3"),
    "vec3",
    "gloss",
    at_point=True,
    has_parameter=True,
    cost=3,
    mean=1.0,
)
# Weight, roughness and normal.
closure("gloss", "vec3 float vec3", "closure_sheen", cost=3)
# The weight of what is below, that of sheen, roughness and normal.
OPERATIONS["below_sheen"] = Operation(
    ("vec3", "vec3", "float", "vec3"), "vec3", "gloss", at_point=True, cost=3, mean=1.0
)
