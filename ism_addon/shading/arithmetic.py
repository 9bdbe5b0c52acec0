# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations of the nodes Math, Map Range, Clamp and Mix of numbers, as Cycles defines them (svm/math_util.h)."""

import math

from .operations import register, set_cost


def divide(a: float, b: float) -> float:
    """a / b, or 0."""
    return a / b if b else 0.0


def clamped(a: float, low: float, high: float) -> float:
    """Clamped to low … high; low must not be larger."""
    return min(max(a, low), high)


def power(a: float, b: float) -> float:
    """a to the power of b, 0 where that is no real number."""
    return 0.0 if (a < 0.0 and b != int(b)) or (not a and b < 0.0) else a**b


def smooth_min(a: float, b: float, distance: float) -> float:
    """The smaller number, blended with the other one within a distance."""
    h = max(distance - abs(a - b), 0.0) / distance if distance else 0.0
    return min(a, b) - h**3 * distance / 6.0


def fraction(a: float, low: float, high: float) -> float:
    """Of the way from low to high."""
    return divide(a - low, high - low)


def smoothstep(a: float, low: float, high: float) -> float:
    """A cubic step from low to high."""
    t = clamped(fraction(a, low, high), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def smootherstep(a: float, low: float, high: float) -> float:
    """A step of fifth degree."""
    t = clamped(fraction(a, low, high), 0.0, 1.0)
    return t**3 * (t * (t * 6.0 - 15.0) + 10.0)


def fract(a: float) -> float:
    """What is above the next smaller whole number."""
    return a - math.floor(a)


register(
    "arithmetic",
    "float",
    "float",
    math_sqrt=lambda a: math.sqrt(max(a, 0.0)),
    math_inverse_sqrt=lambda a: 1.0 / math.sqrt(a) if a > 0.0 else 0.0,
    math_absolute=abs,
    math_exponent=lambda a: math.exp(min(a, 700.0)),
    math_sign=lambda a: float(a > 0.0) - float(a < 0.0),
    math_round=lambda a: math.floor(a + 0.5),
    math_floor=math.floor,
    math_ceil=math.ceil,
    math_trunc=math.trunc,
    math_fract=fract,
    math_sine=math.sin,
    math_cosine=math.cos,
    math_tangent=math.tan,
    math_arcsine=lambda a: math.asin(clamped(a, -1.0, 1.0)),
    math_arccosine=lambda a: math.acos(clamped(a, -1.0, 1.0)),
    math_arctangent=math.atan,
    math_sinh=lambda a: math.sinh(clamped(a, -700.0, 700.0)),
    math_cosh=lambda a: math.cosh(min(abs(a), 700.0)),
    math_tanh=math.tanh,
    math_radians=math.radians,
    math_degrees=math.degrees,
    saturate=lambda a: clamped(a, 0.0, 1.0),
)
register(
    "arithmetic",
    "float float",
    "float",
    math_add=lambda a, b: a + b,
    math_subtract=lambda a, b: a - b,
    math_multiply=lambda a, b: a * b,
    math_power=power,
    math_divide=divide,
    math_logarithm=lambda a, b: divide(math.log(a), math.log(b)) if a > 0.0 and b > 0.0 else 0.0,
    math_minimum=min,
    math_maximum=max,
    math_less_than=lambda a, b: float(a < b),
    math_greater_than=lambda a, b: float(a > b),
    math_modulo=lambda a, b: math.fmod(a, b) if b else 0.0,
    math_floored_modulo=lambda a, b: a - math.floor(a / b) * b if b else 0.0,
    math_snap=lambda a, b: math.floor(divide(a, b)) * b,
    math_pingpong=lambda a, b: abs(fract((a - b) / (2.0 * b)) * 2.0 * b - b) if b else 0.0,
    math_arctan2=math.atan2,
)
register(
    "arithmetic",
    "float float float",
    "float",
    math_multiply_add=lambda a, b, c: a * b + c,
    math_compare=lambda a, b, c: float(abs(a - b) <= max(c, 1e-5)),
    math_smooth_min=smooth_min,
    math_smooth_max=lambda a, b, c: -smooth_min(-a, -b, c),
    math_wrap=lambda a, high, low: a - (high - low) * math.floor((a - low) / (high - low)) if high != low else low,
    clamp_minmax=lambda a, low, high: min(max(a, low), high),
    clamp_range=lambda a, one, other: clamped(a, min(one, other), max(one, other)),
    fraction_linear=fraction,
    fraction_smoothstep=smoothstep,
    fraction_smootherstep=smootherstep,
    mix_float=lambda t, a, b: a * (1.0 - t) + b * t,
)
register(
    "arithmetic",
    "float float float float",
    "float",
    fraction_stepped=lambda a, low, high, steps: (
        math.floor(fraction(a, low, high) * (steps + 1.0)) / steps if steps > 0.0 else 0.0
    ),
)
set_cost(3, "math_power")
