# SPDX-License-Identifier: GPL-3.0-or-later
"""All settings: label, meaning, unit, range and default, declared once.

Blender's property groups, the panels' tooltips, the command line's flags and docs/settings.md
are made from these fields. Sections are frozen dataclasses, so settings compare by value.
"""

from dataclasses import dataclass

from ..choices import DebugView, Method, Resolution
from .occlusion import SSAO
from .setting_fields import setting


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
    sky_dome: bool = setting(
        False,
        "Sky Dome",
        "Place virtual point lights on the world too, more of them where it is bright: its light casts shadows. "
        "They are taken from those of the lights. Off, ambient occlusion darkens the world's light",
        method=Method.SHADOW_MAPS,
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

    @property
    def of_world(self) -> bool:
        """Whether the world's light has shadows."""
        return self.enabled and (self.world if self.method is Method.RAY_TRACED else self.sky_dome)


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
    ssao: SSAO = SSAO()  # noqa: RUF009 (it is frozen)
    quality: Quality = FINAL
    #: Whether the render pass AO is asked for.
    occlusion_pass: bool = False
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
