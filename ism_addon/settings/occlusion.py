# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of ambient occlusion."""

import math
from dataclasses import dataclass

from ..choices import OccludedLight, OcclusionSampling, RadiusUnit
from .setting_fields import setting


@dataclass(frozen=True)
class SSAO:
    """Look of the ambient occlusion."""

    enabled: bool = setting(True, "Ambient Occlusion", "Darken light in creases and contacts")
    light: OccludedLight = setting(  # noqa: RUF009 (what it returns is a field)
        OccludedLight.UNSHADOWED,
        "Darkens",
        "Which light ambient occlusion darkens",
    )
    sampling: OcclusionSampling = setting(  # noqa: RUF009 (what it returns is a field)
        OcclusionSampling.HORIZONS,
        "Sampling",
        "How surfaces that darken others are found. On the screen, at half resolution, both take about the same time",
    )
    unit: RadiusUnit = setting(  # noqa: RUF009 (what it returns is a field)
        RadiusUnit.METERS,
        "Radius In",
        "In what the radius is measured",
    )
    radius: float = setting(
        0.5,
        "Radius",
        "How far away a surface can still darken another. Larger darkens wider creases; costs no time",
        low=0.0,
        high=1e6,
        soft_high=10.0,
        unit="DISTANCE",
    )
    radius_pixels: float = setting(
        50.0,
        "Radius",
        "How far away a surface can still darken another, in pixels of the picture. "
        "Larger darkens wider creases; costs no time",
        low=0.0,
        high=1e5,
        soft_high=500.0,
        unit="PIXEL",
    )
    cone_angle: float = setting(
        math.radians(160.0),
        "Cone Angle",
        "Opening angle of the cone around the surface's normal that is searched for occluders. "
        "Narrow finds only what is straight above, wide also what is at the sides",
        low=math.radians(1.0),
        high=math.pi,
        unit="ANGLE",
    )
    intensity: float = setting(
        1.0,
        "Intensity",
        "Strength of the darkening. At 0 the pass is left out",
        low=0.0,
        high=10.0,
        soft_high=4.0,
    )
    power: float = setting(
        1.0,
        "Power",
        "The exponent of what light is left: above 1, creases are darker and flat parts stay as they are",
        low=0.1,
        high=10.0,
        soft_high=4.0,
    )
    tint: tuple[float, float, float] = setting(
        (0.0, 0.0, 0.0),
        "Tint",
        "The color of full occlusion: what is left of the light there, for red, green and blue",
        low=0.0,
        high=1.0,
        unit="COLOR",
    )
    attenuation: float = setting(
        1.0,
        "Attenuation",
        "How quickly an occluder's darkening fades with its distance, to nothing at the radius. At 0 it does not fade",
        low=0.0,
        high=100.0,
        soft_high=8.0,
    )
    thickness: float = setting(
        0.5,
        "Thickness",
        "How far surfaces reach behind what is seen of them, as a fraction of the radius: light passes behind "
        "thin ones. "
        "For the sampling Horizons only",
        low=0.0,
        high=10.0,
        soft_high=1.0,
    )
