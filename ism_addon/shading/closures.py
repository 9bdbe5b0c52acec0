# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations that add shaders to the closures of a surface, and what such shaders leave to those below them.

Weights are colors, as the layers above can be tinted. The functions are in gpu/glsl/nodes/closures.glsl and gloss.glsl.
"""

from .operations import OPERATIONS, Operation

#: Operations that add a lobe of microfacets, that change those, and that add others than Lambert's.
GLOSSY = "closure_glossy", "closure_metal", "closure_dielectric", "closure_glass"
COAT = ("closure_coat",)
EXTRA = "closure_anisotropy", "closure_beckmann", "closure_sheen", "closure_rough_diffuse"

#: The operation by which bumps lose light.
BUMPS = "closure_bump_shadowing"

#: Operations that do not end with the normal.
WITHOUT_NORMAL = "closure_transparent", "closure_pass_limit", "closure_emission"


def closure(name: str, operands: str, *, file: str = "gloss", parameter: bool = False, cost: int = 1) -> None:
    """Register an operation that adds to the closures at a point. `operands`: types separated by spaces."""
    OPERATIONS[name] = Operation(tuple(operands.split()), "", file, at_point=True, has_parameter=parameter, cost=cost)


def below(name: str, operands: str, *, parameter: bool = False, cost: int) -> None:
    """Register an operation that gives the weight of what is below a layer. Its first operand is that of the layer."""
    OPERATIONS[name] = Operation(
        tuple(operands.split()), "vec3", "gloss", at_point=True, has_parameter=parameter, cost=cost, mean=1.0
    )


# What passes, with the parameter 1 if it may be colored; the most that camera rays may pass; and what is emitted.
closure("closure_transparent", "vec3", file="closures")
closure("closure_pass_limit", "float", file="closures")
closure("closure_emission", "vec3", file="closures")
# The parameter of lobes of microfacets, and of rough diffuse ones: 1 if light is reflected between them more than once.

# What is reflected, and the normal.
closure("closure_diffuse", "vec3 vec3", file="closures")
# Weight, color, roughness and normal.
closure("closure_rough_diffuse", "vec3 vec3 float vec3", file="closures", parameter=True)
# Weight, color, roughness and normal.
closure("closure_glossy", "vec3 vec3 float vec3", parameter=True, cost=4)
# Weight, color, tint at grazing angles, roughness and normal.
closure("closure_metal", "vec3 vec3 vec3 float vec3", parameter=True, cost=6)
# Weight, index of refraction, its level, tint, roughness and normal.
closure("closure_dielectric", "vec3 float float vec3 float vec3", parameter=True, cost=8)
below("below_dielectric", "vec3 float float vec3 float vec3", parameter=True, cost=4)
# Weight, color, index of refraction, roughness and normal.
closure("closure_glass", "vec3 vec3 float float vec3", parameter=True, cost=6)
# Aspect, rotation, tangent and normal: of all glossy lobes but the coat.
closure("closure_anisotropy", "float float vec3 vec3")
# The normal: of all glossy lobes but the coat.
closure("closure_beckmann", "vec3")
# A normal that bumps have changed. The parameter is 1 or 2, see materials/bump_shadowing.glsl.
closure(BUMPS, "vec3", file="closures", parameter=True)
# Weight, index of refraction, roughness and normal.
closure("closure_coat", "vec3 float float vec3", parameter=True, cost=4)
# The weight of both, the coat's own weight, index of refraction, roughness, tint and normal.
below("below_coat", "vec3 float float float vec3 vec3", parameter=True, cost=3)
# Weight, roughness and normal.
closure("closure_sheen", "vec3 float vec3", cost=3)
# The weight of both, that of sheen, roughness and normal.
below("below_sheen", "vec3 vec3 float vec3", cost=3)
