# SPDX-License-Identifier: GPL-3.0-or-later
"""All settings: label, meaning, unit, range and default, declared once.

Blender's property groups, the panels' tooltips, the command line's flags and docs/settings.md
are made from these fields. Sections are frozen dataclasses, so settings compare by value.
"""

import math
from collections.abc import Iterator
from dataclasses import Field, dataclass, field, fields
from typing import Any

from .choices import Choice, DebugView, Method, OcclusionSampling, Resolution


@dataclass(frozen=True)
class Control:
    """How a setting appears to the user. Units are Blender's names of property subtypes."""

    label: str
    meaning: str
    low: float | None = None
    high: float | None = None
    soft_high: float | None = None
    unit: str = "NONE"
    method: Method | None = None  # the only method that uses the setting


def setting(default: Any, label: str, meaning: str, method: Method | None = None, **control: Any) -> Any:
    """A dataclass field with its Control as metadata."""
    if method:
        meaning += f". For the method {method.label} only"
    return field(default=default, metadata={"control": Control(label, meaning, method=method, **control)})


@dataclass(frozen=True)
class Shadow:
    """Look of the shadows."""

    enabled: bool = setting(
        True, "Shadows", "Draw the lights' shadows. Off, every light reaches every surface that faces it"
    )
    method: Method = setting(  # noqa: RUF009 (what it returns is a field)
        Method.RAY_TRACED,
        "Method",
        "How shadows are computed",
    )
    world: bool = setting(
        True,
        "World Shadows",
        "Trace shadow rays to the world too: its light is exact, and takes about as long as that of a large light. "
        "Off, ambient occlusion darkens it",
        method=Method.RAY_TRACED,
    )
    splat_size: float = setting(
        1.15,
        "Splat Size",
        "Radius of a point's disc over the radius that its share of the area has. "
        "Larger closes holes and leaks, and darkens beside edges. Costs a little time",
        low=0.1,
        high=8.0,
        soft_high=3.0,
        method=Method.SHADOW_MAPS,
    )
    bias: float = setting(
        0.5,
        "Bias",
        "How far a surface is moved towards the light before it is compared with a shadow map, in texels of the map. "
        "Less shows stripes of false shadow, more lets light through at contacts. Costs no time",
        low=0.0,
        high=16.0,
        soft_high=4.0,
        method=Method.SHADOW_MAPS,
    )
    fill_holes: bool = setting(
        True,
        "Fill Holes",
        "Close the gaps between the points of a shadow map by pull-push interpolation. Costs a little time",
        method=Method.SHADOW_MAPS,
    )
    fill_threshold: float = setting(
        0.02,
        "Fill Threshold",
        "Depths that differ by less than this fraction of their distance count as one surface when holes are filled",
        low=0.0,
        high=1.0,
        soft_high=0.2,
        unit="FACTOR",
        method=Method.SHADOW_MAPS,
    )


@dataclass(frozen=True)
class SSAO:
    """Look of the ambient occlusion."""

    enabled: bool = setting(
        True,
        "Ambient Occlusion",
        "Darken the world's light in creases and contacts, in screen space at half resolution. "
        "Not used while the method Ray Traced draws World Shadows",
    )
    sampling: OcclusionSampling = setting(  # noqa: RUF009 (what it returns is a field)
        OcclusionSampling.HORIZONS,
        "Sampling",
        "How occluders are found. Both take about the same time",
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


@dataclass(frozen=True)
class Quality:
    """Sampling: how many samples, and when to stop; sizes of the shadow maps."""

    samples: int = setting(
        16,
        "Samples",
        "Samples that are averaged, each with other points on the lights and in the pixels. "
        "More smooth edges and penumbrae; time grows in proportion. From 16 on, a picture that is then noisy goes "
        "on where it is, up to four times as many: above an estimated error of 1 % if it is small, 5 % in HD",
        low=1,
        high=65536,
        soft_high=256,
    )
    error_threshold: float = setting(
        0.01,
        "Error Threshold",
        "Tiles of 8×8 pixels have no more samples when their estimated error is below this fraction of the render's "
        "mean brightness, and the render is done when all are; after 16 samples at the earliest. "
        "Less is smoother and takes longer; 0 draws all samples",
        low=0.0,
        high=1.0,
        soft_high=0.2,
    )
    time_limit: float = setting(
        0.0,
        "Time Limit",
        "No sample is begun later than this, counted from when the scene has been read; one is always drawn. "
        "0 is no limit",
        low=0.0,
        high=1e6,
        unit="TIME_ABSOLUTE",
    )
    virtual_lights: int = setting(
        105,
        "Virtual Point Lights",
        "Virtual point lights in a sample, distributed among the lights; each has a shadow map of its own. "
        "More give smoother penumbrae; time grows in proportion",
        low=1,
        high=4096,
        soft_high=1024,
        method=Method.SHADOW_MAPS,
    )
    map_size: int = setting(
        128,
        "Map Size",
        "Width of one shadow map, which covers a virtual light's whole hemisphere. "
        "More give sharper contacts; needs more points to be filled",
        low=8,
        high=4096,
        soft_high=512,
        unit="PIXEL",
        method=Method.SHADOW_MAPS,
    )
    map_points: int = setting(
        32768,
        "Points per Map",
        "Points that stand for the scene in each shadow map. "
        "More let smaller things cast a shadow; time grows in proportion",
        low=1,
        high=1 << 20,
        soft_high=1 << 18,
        method=Method.SHADOW_MAPS,
    )


@dataclass(frozen=True)
class ViewportQuality(Quality):
    """Sampling in the viewport, and its resolution."""

    resolution: Resolution = setting(  # noqa: RUF009 (what it returns is a field)
        Resolution.FULL,
        "Resolution",
        "Width and height of what is drawn, relative to the viewport, to which it is enlarged. "
        "Less is coarser; time falls with the number of pixels",
    )


#: Defaults of final renders, and of the viewport, where latency matters.
FINAL = Quality()
VIEWPORT = ViewportQuality(virtual_lights=32, map_size=64, map_points=8192)


@dataclass(frozen=True)
class Settings:
    """All inputs of an image, apart from the scene and the view."""

    shadow: Shadow = Shadow()
    ssao: SSAO = SSAO()
    quality: Quality = FINAL
    #: False: work that does not change the image is not skipped, and nothing is reused from the previous image. For
    #: measurements of the time that shortcuts save.
    shortcuts: bool = True
    debug_view: DebugView = setting(  # noqa: RUF009 (what it returns is a field)
        DebugView.SAMPLE_COLOR,
        "Debug View",
        "Show an intermediate result in the viewport instead of the render. Final renders ignore it",
    )


#: Sections by the name that scripts and the command line use.
SECTIONS: dict[str, type] = {"shadow": Shadow, "ssao": SSAO, "quality": Quality}


def setting_fields(section: type) -> Iterator[tuple[Field, Control]]:
    """The fields of a section that are settings, with their Controls."""
    for member in fields(section):
        if "control" in member.metadata:
            yield member, member.metadata["control"]


def help_text(member: Field, control: Control) -> str:
    """The meaning of a setting; of a choice, also that of each value."""
    choices = type(member.default) if isinstance(member.default, Choice) else ()
    return ". ".join([control.meaning, *(f"{choice}: {choice.meaning}" for choice in choices)])
