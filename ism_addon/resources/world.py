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
BACKGROUND = Target("background", "Radiance of a world that varies, where no surface is, W/(sr m²)")
AMBIENT_OCCLUSION = _occlusion("ambient_occlusion", "Ambient occlusion: white is open", "Ambient Occlusion")
