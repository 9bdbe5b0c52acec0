# SPDX-License-Identifier: GPL-3.0-or-later
"""Resources of the world's light and of the background, see the package."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..resource_types import Lifetime, Resource, Target

if TYPE_CHECKING:
    from ..gpu.passes.environment.bake_world import BakedWorld
    from ..gpu.passes.light_selection.scene_portals import ScenePortals

BAKED_WORLD: Resource[BakedWorld] = Resource(
    "baked_world", "Map of a world that varies, and its tables", Lifetime.SCENE
)
PORTALS: Resource[ScenePortals | None] = Resource(
    "portals", "Openings that the world's light comes through", Lifetime.PICTURE
)


def _occlusion(name: str, about: str, label: str) -> Target:
    return Target(name, about, format="r16f", divisor=2, neutral=(1.0,), label=label)


RAW_OCCLUSION = _occlusion(
    "raw_occlusion", "Ambient occlusion before blurring: white is open", "Ambient Occlusion (Raw)"
)
HALF_BLURRED_OCCLUSION = _occlusion(
    "half_blurred_occlusion", "Ambient occlusion, blurred in rows only", "Ambient Occlusion (Blurred in X)"
)
#: As far as the distances of rays of ambient occlusion are stored. m
NO_OCCLUDER_NEAR = 65504.0
OCCLUSION_DISTANCE = Target(
    *("occlusion_distance", "To the nearest surface along a random ray, in metres"),
    format="r16f",
    neutral=(NO_OCCLUDER_NEAR,),
    label="Occlusion Distance",
)
FILTERED_ONCE = Target("filtered_once", "traced_occlusion by fewer neighbours", format="rg16f", neutral=(1.0, 1.0))
TRACED_OCCLUSION = Target(
    *("traced_occlusion", "Ambient occlusion by rays, filtered, and by each pixel's own ray: white is open"),
    format="rg16f",
    neutral=(1.0, 1.0),
    label="Traced Occlusion",
)
STEADY_OCCLUSION = Target(
    "steady_occlusion", "traced_occlusion, blended over the last views", format="rg16f", neutral=(1.0, 1.0)
)
WORLD_PREDICTION = Target(
    "world_prediction", "direct_prediction of the world alone, where occlusion darkens only it", divisor=0
)
WORLD_RESIDUAL = Target("world_residual", "The same of direct_residual", divisor=0)

# The render pass AO has the same targets as the image.
SAMPLE_OCCLUSION = Target("sample_occlusion", "A sample of the render pass AO")
SAMPLE_OCCLUSION_RESIDUAL = Target("sample_occlusion_residual", "As sample_residual")
SAMPLE_OCCLUSION_HEADROOM = Target("sample_occlusion_headroom", "As sample_headroom", format="r32f")
SUM_OCCLUSION = Target("sum_occlusion", "As sum_color", Lifetime.PICTURE)
SUM_OCCLUSION_RESIDUAL = Target("sum_occlusion_residual", "As sum_residual", Lifetime.PICTURE)
SUM_OCCLUSION_WEIGHTS = Target("sum_occlusion_weights", "As sum_weights", Lifetime.PICTURE)
SUM_OCCLUSION_HEADROOM = Target("sum_occlusion_headroom", "As sum_headroom", Lifetime.PICTURE, format="r32f")
OCCLUSION_IMAGE = Target("occlusion_image", "The render pass AO of all samples so far")
BACKGROUND = Target("background", "Radiance of a world that varies, where no surface is, W/(sr m²)")
AMBIENT_OCCLUSION = _occlusion("ambient_occlusion", "Ambient occlusion: white is open", "Ambient Occlusion")
