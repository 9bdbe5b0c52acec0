# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts nodes that change colours."""

from collections.abc import Mapping

import numpy as np

from ....color import MAX_TEMPERATURE, MIN_TEMPERATURE, REC709, between_spaces, blackbody, xyz_from
from ....shading.builder import Value, constant
from ....shading.node_graph import NUMBERS
from ..materials.images import working_space
from .reader import Converter, NodeView

#: Rows of tables of ramps and curves.
TABLE_ROWS = NUMBERS["table"] // 4


def mix_rgb(view: NodeView) -> Mapping[str, Value]:
    """Mix of colors, as it was before Blender 3.4."""
    node = view.node
    factor = view.call("saturate", view.value("Fac"))
    result = view.call(f"blend_{node.blend_type.lower()}", factor, view.value("Color1"), view.value("Color2"))
    return {"Color": view.call("vector_saturate", result) if node.use_clamp else result}


def separate_color(view: NodeView) -> Mapping[str, Value]:
    """Separate Color."""
    color, mode = view.value(0), view.node.mode.lower()
    if mode != "rgb":
        color = view.call(f"{mode}_from_rgb", color)
    return {
        name: view.call(f"separate_{axis}", color) for name, axis in zip(("Red", "Green", "Blue"), "xyz", strict=True)
    }


def combine_color(view: NodeView) -> Mapping[str, Value]:
    """Combine Color."""
    color, mode = view.call("combine_xyz", *(view.value(k) for k in range(3))), view.node.mode.lower()
    return {"Color": color if mode == "rgb" else view.call(f"rgb_from_{mode}", color)}


def hue_saturation(view: NodeView) -> Mapping[str, Value]:
    """Hue/Saturation/Value."""
    keys = "Hue", "Saturation", "Value", "Fac", "Color"
    return {"Color": view.call("hue_saturation", *(view.value(key) for key in keys))}


def invert(view: NodeView) -> Mapping[str, Value]:
    """Invert Color."""
    return {"Color": view.call("invert", view.value("Fac"), view.value("Color"))}


def gamma(view: NodeView) -> Mapping[str, Value]:
    """Gamma."""
    return {"Color": view.call("gamma", view.value("Color"), view.value("Gamma"))}


def bright_contrast(view: NodeView) -> Mapping[str, Value]:
    """Brightness/Contrast."""
    return {"Color": view.call("bright_contrast", *(view.value(key) for key in ("Color", "Bright", "Contrast")))}


def rgb_to_bw(view: NodeView) -> Mapping[str, Value]:
    """RGB to BW."""
    return {"Val": view.reader.luminance_of(view.value("Color"))}


def color_ramp(view: NodeView) -> Mapping[str, Value]:
    """Color Ramp."""
    ramp = view.node.color_ramp
    table = constant([tuple(ramp.evaluate(k / (TABLE_ROWS - 1))) for k in range(TABLE_ROWS)])
    name = "color_ramp_constant" if ramp.interpolation == "CONSTANT" else "color_ramp"
    color = view.call(name, table, view.value("Fac"))
    return {"Color": view.call("color_of", color), "Alpha": view.call("alpha_of", color)}


def curves(view: NodeView, curve_count: int) -> tuple[str, Value, Value, Value]:
    """The operation of a node with curves, its table, and the positions of the table's ends."""
    mapping = view.node.mapping
    mapping.initialize()
    every = list(mapping.curves)[:curve_count]
    points = [point.location[0] for curve in every for point in curve.points]
    low, high = min([0.0, *points]), max([1.0, *points])
    positions = np.linspace(low, high, TABLE_ROWS)
    table = np.zeros((TABLE_ROWS, 4))
    combined = mapping.curves[3] if len(mapping.curves) > 3 else None
    for k, curve in enumerate(every):
        inner = [mapping.evaluate(combined, x) if combined is not None else x for x in positions]
        table[:, k] = [mapping.evaluate(curve, x) for x in inner]
    name = "rgb_curves_extrapolated" if mapping.extend == "EXTRAPOLATED" else "rgb_curves"
    return name, constant(table), constant(low), constant(high)


def rgb_curves(view: NodeView) -> Mapping[str, Value]:
    """RGB Curves."""
    name, *table = curves(view, 3)
    return {"Color": view.call(name, *table, view.value("Fac"), view.value("Color"))}


def vector_curves(view: NodeView) -> Mapping[str, Value]:
    """Vector Curves."""
    name, *table = curves(view, 3)
    return {"Vector": view.call(name, *table, view.value("Fac"), view.value("Vector"))}


def float_curve(view: NodeView) -> Mapping[str, Value]:
    """Float Curve."""
    name, *table = curves(view, 1)
    color = view.call(name, *table, view.value("Factor"), view.call("grey", view.value("Value")))
    return {"Value": view.call("separate_x", color)}


def blackbody_color(view: NodeView) -> Mapping[str, Value]:
    """Blackbody: a table over the inverse of the temperature, between the colours of which there is little change."""
    ends = 1.0 / MIN_TEMPERATURE, 1.0 / MAX_TEMPERATURE
    to_working = between_spaces(working_space(), REC709)
    colors = [np.maximum(to_working @ blackbody(1.0 / x), 0.0) for x in np.linspace(*ends, TABLE_ROWS)]
    temperature = view.call(
        "clamp_minmax", view.value("Temperature"), *map(constant, (MIN_TEMPERATURE, MAX_TEMPERATURE))
    )
    inverse = view.call("math_divide", constant(1.0), temperature)
    position = view.call("fraction_linear", inverse, *map(constant, ends))
    table = constant(np.c_[colors, np.ones(TABLE_ROWS)])
    return {"Color": view.call("color_of", view.call("color_ramp", table, position))}


#: The sensitivity of the eye to wavelengths: weights, centres and widths of bells, nm (Wyman, Sloan & Shirley 2013).
XYZ_BELLS = (
    ((1.056, 599.8, 37.9, 31.0), (0.362, 442.0, 16.0, 26.7), (-0.065, 501.1, 20.4, 26.2)),
    ((0.821, 568.8, 46.9, 40.5), (0.286, 530.9, 16.3, 31.1)),
    ((1.217, 437.0, 11.8, 36.0), (0.681, 459.0, 26.0, 13.8)),
)
MIN_WAVELENGTH, MAX_WAVELENGTH = 380.0, 780.0
#: Cycles divides by this, so that no colour is brighter than 1.
BRIGHTEST_WAVELENGTH = 2.52


def wavelength(view: NodeView) -> Mapping[str, Value]:
    """Wavelength."""
    x = np.linspace(MIN_WAVELENGTH, MAX_WAVELENGTH, TABLE_ROWS)
    xyz = np.array(
        [
            sum(
                w * np.exp(-0.5 * ((x - mean) / np.where(x < mean, below, above)) ** 2)
                for w, mean, below, above in bells
            )
            for bells in XYZ_BELLS
        ]
    )
    colors = np.maximum(np.linalg.solve(xyz_from(working_space()), xyz).T / BRIGHTEST_WAVELENGTH, 0.0)
    ends = map(constant, (MIN_WAVELENGTH, MAX_WAVELENGTH))
    position = view.call("fraction_linear", view.value("Wavelength"), *ends)
    table = constant(np.c_[colors, np.ones(TABLE_ROWS)])
    return {"Color": view.call("color_of", view.call("color_ramp", table, position))}


CONVERTERS: dict[str, Converter] = {
    "ShaderNodeMixRGB": mix_rgb,
    "ShaderNodeSeparateColor": separate_color,
    "ShaderNodeCombineColor": combine_color,
    "ShaderNodeHueSaturation": hue_saturation,
    "ShaderNodeInvert": invert,
    "ShaderNodeGamma": gamma,
    "ShaderNodeBrightContrast": bright_contrast,
    "ShaderNodeRGBToBW": rgb_to_bw,
    "ShaderNodeValToRGB": color_ramp,
    "ShaderNodeRGBCurve": rgb_curves,
    "ShaderNodeVectorCurve": vector_curves,
    "ShaderNodeFloatCurve": float_curve,
    "ShaderNodeBlackbody": blackbody_color,
    "ShaderNodeWavelength": wavelength,
}
