# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations of nodes that change colours: blending, hue and saturation, curves and ramps, as in Cycles."""

from collections.abc import Callable

import numpy as np

from .operations import register, set_cost


def mix(t: float, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Linear interpolation; t may be outside of 0 … 1."""
    return a + t * (b - a)


def mixing(blend: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Callable[..., np.ndarray]:
    """The operation that mixes the first colour with what `blend` makes of both."""
    return lambda t, a, b: mix(t, a, blend(a, b))


def of_each(function: Callable[[float, float, float], float]) -> Callable[..., np.ndarray]:
    """The operation of a factor and two colours by component."""
    return lambda t, a, b: np.array([function(t, one, other) for one, other in zip(a, b, strict=True)])


def screen(t: float, a: float, b: float) -> float:
    """Inverse of the product of inverses."""
    return 1.0 - (1.0 - t + t * (1.0 - b)) * (1.0 - a)


def overlay(t: float, a: float, b: float) -> float:
    """Product where the first colour is dark, screen where it is not."""
    if a < 0.5:
        return a * (1.0 - t + 2.0 * t * b)
    return 1.0 - (1.0 - t + 2.0 * t * (1.0 - b)) * (1.0 - a)


def dodge(t: float, a: float, b: float) -> float:
    """Divided by the inverse."""
    divisor = 1.0 - t * b
    return a and (1.0 if divisor <= 0.0 else min(a / divisor, 1.0))


def burn(t: float, a: float, b: float) -> float:
    """Inverse divided by the second colour, and inverted."""
    divisor = 1.0 - t + t * b
    return 0.0 if divisor <= 0.0 else min(max(1.0 - (1.0 - a) / divisor, 0.0), 1.0)


def soft_light(t: float, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Between product and screen."""
    return mix(t, a, (1.0 - a) * b * a + a * (1.0 - (1.0 - b) * (1.0 - a)))


def hsv_from_rgb(rgb: np.ndarray) -> np.ndarray:
    """Hue, saturation and value (3,); colours may be brighter than 1."""
    high, low = float(rgb.max()), float(rgb.min())
    delta = high - low
    saturation = delta / high if high else 0.0
    if not saturation:
        return np.array([0.0, 0.0, high])
    red, green, blue = (high - rgb) / delta
    if rgb[0] == high:
        hue = blue - green
    elif rgb[1] == high:
        hue = 2.0 + red - blue
    else:
        hue = 4.0 + green - red
    return np.array([hue / 6.0 % 1.0, saturation, high])


def rgb_from_hsv(hsv: np.ndarray) -> np.ndarray:
    """The inverse; for any hue."""
    hue, saturation, value = hsv
    if not saturation:
        return np.full(3, value)
    distance = np.abs((hue * 6.0 + np.array([0.0, 4.0, 2.0])) % 6.0 - 3.0) - 1.0
    result: np.ndarray = value * (1.0 - saturation * (1.0 - np.clip(distance, 0.0, 1.0)))
    return result


def hsl_from_rgb(rgb: np.ndarray) -> np.ndarray:
    """Hue, saturation and lightness (3,). Of colours brighter than 1 only the lightness is limited."""
    high, low = float(rgb.max()), float(rgb.min())
    hue, _, _ = hsv_from_rgb(rgb)
    lightness, delta = min((high + low) / 2.0, 1.0), high - low
    most = 2.0 - high - low if lightness > 0.5 else high + low
    return np.array([hue, delta / most, lightness]) if delta and most else np.array([0.0, 0.0, lightness])


def rgb_from_hsl(hsl: np.ndarray) -> np.ndarray:
    """The inverse."""
    hue, saturation, lightness = hsl
    pure = np.clip(np.abs((hue * 6.0 + np.array([0.0, 4.0, 2.0])) % 6.0 - 3.0) - 1.0, 0.0, 1.0)
    result: np.ndarray = (pure - 0.5) * ((1.0 - abs(2.0 * lightness - 1.0)) * saturation) + lightness
    return result


def blend_hue(t: float, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The second colour's hue."""
    hue, saturation, _ = hsv_from_rgb(b)
    return mix(t, a, rgb_from_hsv(np.array([hue, *hsv_from_rgb(a)[1:]]))) if saturation else a


def blend_saturation(t: float, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The second colour's saturation."""
    hue, saturation, value = hsv_from_rgb(a)
    return rgb_from_hsv(np.array([hue, mix(t, saturation, hsv_from_rgb(b)[1]), value])) if saturation else a


def blend_value(t: float, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The second colour's value."""
    hue, saturation, value = hsv_from_rgb(a)
    return rgb_from_hsv(np.array([hue, saturation, mix(t, value, hsv_from_rgb(b)[2])]))


def blend_color(t: float, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The second colour's hue and saturation."""
    hue, saturation, _ = hsv_from_rgb(b)
    return mix(t, a, rgb_from_hsv(np.array([hue, saturation, hsv_from_rgb(a)[2]]))) if saturation else a


def hue_saturation(hue: float, saturation: float, value: float, t: float, color: np.ndarray) -> np.ndarray:
    """The node Hue/Saturation/Value, whose neutral values are .5, 1 and 1."""
    own_hue, own_saturation, own_value = hsv_from_rgb(color)
    changed = (own_hue + hue + 0.5) % 1.0, min(max(own_saturation * saturation, 0.0), 1.0), own_value * value
    return np.maximum(mix(t, color, rgb_from_hsv(np.array(changed))), 0.0)


def gamma(color: np.ndarray, exponent: float) -> np.ndarray:
    """Positive components to the power of the exponent."""
    return np.where(color > 0.0, np.maximum(color, 1e-30) ** exponent, color) if exponent else np.ones(3)


def table_at(table: np.ndarray, position: float, extrapolate: bool = False) -> np.ndarray:
    """(4,): the row of a table (256,4) at a position in 0 … 1, interpolated linearly."""
    last = len(table) - 1
    inside = min(max(position, 0.0), 1.0) * last
    row = min(int(inside), last - 1)
    result: np.ndarray = mix(inside - row, table[row], table[row + 1])
    if extrapolate and position < 0.0:
        return result + (table[1] - table[0]) * position * last
    if extrapolate and position > 1.0:
        return result + (table[last] - table[last - 1]) * (position - 1.0) * last
    return result


def curves(extrapolate: bool) -> Callable[..., np.ndarray]:
    """The node RGB Curves: each component by its column of a table, whose rows are from low to high."""

    def function(table: np.ndarray, low: float, high: float, t: float, color: np.ndarray) -> np.ndarray:
        positions = (color - low) / (high - low)
        return mix(t, color, np.array([table_at(table, x, extrapolate)[k] for k, x in enumerate(positions)]))

    return function


register(
    "colors",
    "float vec3 vec3",
    "vec3",
    blend_mix=mix,
    blend_darken=mixing(np.minimum),
    blend_multiply=mixing(np.multiply),
    blend_burn=of_each(burn),
    blend_lighten=mixing(np.maximum),
    blend_screen=of_each(screen),
    blend_dodge=of_each(dodge),
    blend_add=mixing(np.add),
    blend_overlay=of_each(overlay),
    blend_soft_light=soft_light,
    blend_linear_light=lambda t, a, b: a + t * (2.0 * b - 1.0),
    blend_difference=mixing(lambda a, b: np.abs(a - b)),
    blend_exclusion=lambda t, a, b: np.maximum(mix(t, a, a + b - 2.0 * a * b), 0.0),
    blend_subtract=mixing(np.subtract),
    blend_divide=of_each(lambda t, a, b: (1.0 - t) * a + t * a / b if b else a),
    blend_hue=blend_hue,
    blend_saturation=blend_saturation,
    blend_color=blend_color,
    blend_value=blend_value,
)
register(
    "colors",
    "vec3",
    "vec3",
    hsv_from_rgb=hsv_from_rgb,
    rgb_from_hsv=rgb_from_hsv,
    hsl_from_rgb=hsl_from_rgb,
    rgb_from_hsl=rgb_from_hsl,
)
register("colors", "vec3", "float", average=np.mean, largest=np.max)
register("colors", "float", "vec3", grey=lambda a: np.full(3, a))
register("colors", "vec4", "vec3", color_of=lambda a: a[:3])
register("colors", "vec4", "float", alpha_of=lambda a: a[3])
register("colors", "float float float float vec3", "vec3", hue_saturation=hue_saturation)
register("colors", "float vec3", "vec3", invert=lambda t, a: mix(t, a, 1.0 - a))
register("colors", "vec3 float", "vec3", gamma=gamma)
register(
    "colors",
    "vec3 float float",
    "vec3",
    bright_contrast=lambda a, bright, contrast: np.maximum((1.0 + contrast) * a + bright - contrast * 0.5, 0.0),
)
register(
    "tables",
    "table float",
    "vec4",
    color_ramp=table_at,
    color_ramp_constant=lambda table, position: table[int(min(max(position, 0.0), 1.0) * (len(table) - 1))],
)
register(
    "tables",
    "table float float float vec3",
    "vec3",
    rgb_curves=curves(extrapolate=False),
    rgb_curves_extrapolated=curves(extrapolate=True),
)
set_cost(8, "gamma")
set_cost(4, "hue_saturation")
