# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations of procedural textures that are patterns, and of images that are projected onto surfaces, as in Cycles."""

import math
from collections.abc import Callable

import numpy as np

from .arithmetic import clamped, divide, fract, smoothstep
from .operations import OPERATIONS, Operation, register

#: Phase of a wave per unit of length.
WAVE_FREQUENCY = 20.0
#: The steps of the node Magic: which component, the signs of all components in the angle, and what is added to it.
#: Cosines are sines of a larger angle.
COSINE, MINUS_COSINE, SINE, MINUS_SINE = 0.5 * math.pi, -0.5 * math.pi, 0.0, math.pi
MAGIC_STEPS = (
    (1, (1.0, -1.0, 1.0), MINUS_COSINE),
    (0, (1.0, -1.0, -1.0), COSINE),
    (2, (-1.0, -1.0, -1.0), SINE),
    (0, (-1.0, 1.0, -1.0), MINUS_COSINE),
    (1, (-1.0, 1.0, 1.0), MINUS_SINE),
    (1, (-1.0, 1.0, 1.0), MINUS_COSINE),
    (0, (1.0, 1.0, 1.0), COSINE),
    (2, (1.0, 1.0, -1.0), SINE),
    (0, (-1.0, -1.0, 1.0), MINUS_COSINE),
    (1, (1.0, -1.0, 1.0), MINUS_SINE),
)
#: Bits of the random numbers of bricks.
POSITIVE = 0x7FFFFFFF


def off_integers(p: np.ndarray) -> np.ndarray:
    """A point that is moved off whole numbers, where patterns have edges and coordinates rounding errors."""
    return (p + 1e-6) * 0.999999


def triangle(phase: float) -> float:
    """Rises from 0 to 1, and falls again."""
    periods = phase / math.tau
    return 2.0 * abs(periods - math.floor(periods + 0.5))


def magic(p: np.ndarray, scale: float, depth: float, distortion: float) -> np.ndarray:
    """The node Magic Texture: sums of angles, of which depth is the number of steps."""
    x, y, z = np.fmod(p, math.tau) * 5.0 * scale
    v = np.array([math.sin(x + y + z), math.cos(-x + y - z), -math.cos(-x - y + z)])
    if depth > 0.0:
        v *= distortion
    for step, (component, signs, added) in enumerate(MAGIC_STEPS):
        if depth > step:
            v[component] = math.sin(np.dot(signs, v) + added) * distortion
    return 0.5 - (v / (2.0 * distortion) if distortion else v)


def checker(p: np.ndarray) -> float:
    """1 in every second cube, else 0."""
    return float(np.floor(p).sum() % 2.0)


def brick_random(n: int) -> float:
    """A number in 0 … 1 of a brick."""
    n = (n + 1013) & POSITIVE
    n ^= n >> 13
    return ((n * (n * n * 60493 + 19990303) + 1376312589) & POSITIVE) / (POSITIVE + 1.0)


def brick(
    p: np.ndarray,
    bias: float,
    width: float,
    height: float,
    offset: float,
    squash: float,
    mortar_size: float,
    mortar_smooth: float,
    offset_frequency: float,
    squash_frequency: float,
) -> np.ndarray:
    """The node Brick Texture: the share of the second colour, and that of mortar; the third number is 0.

    Rows that are multiples of a frequency have bricks of another width, or are moved along.
    """
    row, along = math.floor(divide(p[1], height)), p[0]
    if int(offset_frequency) and int(squash_frequency):
        width *= 1.0 if row % int(squash_frequency) else squash
        along += 0.0 if row % int(offset_frequency) else width * offset
    column = math.floor(divide(along, width))
    x, y = along - width * column, p[1] - height * row
    tint = clamped(brick_random((row << 16) + (column & 0xFFFF)) + bias, 0.0, 1.0)
    distance = min(x, y, width - x, height - y)
    mortar = 0.0
    if distance < mortar_size:
        mortar = smoothstep(1.0 - distance / mortar_size, 0.0, mortar_smooth) if mortar_smooth else 1.0
    return np.array([tint, mortar, 0.0])


def within_sphere(p: np.ndarray) -> float:
    """1 in the centre of the unit sphere, 0 on it."""
    return max(0.999999 - float(np.linalg.norm(p)), 0.0)


def saturated(function: Callable[[np.ndarray], float]) -> Callable[[np.ndarray], float]:
    """The function, limited to 0 … 1."""
    return lambda p: clamped(function(p), 0.0, 1.0)


register("patterns", "vec3", "vec3", off_integers=off_integers)
register(
    "patterns",
    "vec3 vec3",
    "float",
    wave_bands=lambda p, direction: WAVE_FREQUENCY * (p @ direction),
    wave_rings=lambda p, axes: WAVE_FREQUENCY * np.linalg.norm(p * axes),
)
register(
    "patterns",
    "float",
    "float",
    wave_sin=lambda phase: 0.5 - 0.5 * math.cos(phase),
    wave_saw=lambda phase: fract(phase / math.tau),
    wave_tri=triangle,
)
register("patterns", "vec3 float float float", "vec3", magic=magic)
register(
    "patterns",
    "vec3",
    "float",
    checker=checker,
    **{
        f"gradient_{name}": saturated(function)
        for name, function in {
            "linear": lambda p: p[0],
            "quadratic": lambda p: max(p[0], 0.0) ** 2,
            "easing": lambda p: smoothstep(p[0], 0.0, 1.0),
            "diagonal": lambda p: 0.5 * (p[0] + p[1]),
            "radial": lambda p: math.atan2(p[1], p[0]) / math.tau + 0.5,
            "quadratic_sphere": lambda p: within_sphere(p) ** 2,
            "spherical": within_sphere,
        }.items()
    },
)
register("patterns", "vec3" + " float" * 9, "vec3", brick=brick)
# The parameter is the interpolation's index, times the number of extensions, and the extension's.
for name in ("image_sphere", "image_tube"):
    OPERATIONS[name] = Operation(
        ("image", "vec3"), "vec4", "images/projections", has_parameter=True, with_differences=(1,)
    )
# The width of blending follows the image.
OPERATIONS["image_box"] = Operation(
    ("image", "float", "vec3"), "vec4", "images/projections", at_point=True, has_parameter=True, with_differences=(2,)
)
