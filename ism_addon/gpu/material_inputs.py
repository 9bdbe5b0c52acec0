# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of shaders that include surfaces/bsdf.glsl: the lobes of a pixel's surface."""

from typing import Any

from ..resource_types import Resource, Target
from ..resources import (
    BASE_COLOR,
    COAT,
    GLOSS_REFLECTANCE,
    GLOSS_RISE,
    LTC_ENTRIES,
    RARE_LOBES,
)
from ..scene import Scene
from .frame import Frame

#: Targets of lobes other than Lambert's.
GLOSS = GLOSS_REFLECTANCE, GLOSS_RISE, LTC_ENTRIES
ALL_LOBES = *GLOSS, COAT, RARE_LOBES

#: Must be among the inputs of their passes.
MATERIAL: tuple[Resource[Any], ...] = BASE_COLOR, *ALL_LOBES


def layer_targets(scene: Scene) -> tuple[Target, ...]:
    """The targets of lobes that few scenes have."""
    return *((COAT,) if scene.has_coat else ()), *((RARE_LOBES,) if scene.has_extra else ())


def lobe_targets(scene: Scene) -> tuple[Target, ...]:
    """The targets of lobes that a scene has."""
    return *(GLOSS if scene.has_gloss else ()), *layer_targets(scene)


def material_samplers(frame: Frame) -> dict[str, Any]:
    """Samplers by name."""
    return {"base_color": frame[BASE_COLOR], **{target.name: frame[target] for target in lobe_targets(frame.scene)}}


def material_constants(frame: Frame) -> dict[str, int]:
    """Constants of their shaders."""
    scene = frame.scene
    return {
        "gloss": int(scene.has_gloss),
        "coat": int(scene.has_coat),
        "rare_lobes": int(scene.has_extra),
        "bumps": scene.bump_shadowing,
    }
