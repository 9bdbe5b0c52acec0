# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of shaders that include occlusion/darkening.glsl."""

from typing import Any

from ...resource_types import Target
from ...resources.world import AMBIENT_OCCLUSION, STEADY_OCCLUSION, TRACED_OCCLUSION
from ..frame import Frame


def drawn_target(frame: Frame) -> Target | None:
    """The target with this sample's ambient occlusion, if any is drawn."""
    drawn = (target for target in (TRACED_OCCLUSION, AMBIENT_OCCLUSION) if not frame.is_neutral(target))
    return next(drawn, None)


def occlusion_target(frame: Frame) -> Target | None:
    """The same, or in the first picture what steadies it."""
    return drawn_target(frame) if frame.corrects or frame.is_neutral(STEADY_OCCLUSION) else STEADY_OCCLUSION


def occlusion_constants(target: Target | None) -> dict[str, int]:
    """Constants of the shaders."""
    return {"occlusion": int(target is not None), "traced_occlusion": int(target is not AMBIENT_OCCLUSION)}


def occlusion_uniforms(frame: Frame, target: Target) -> dict[str, Any]:
    """Uniforms of the shaders."""
    ssao = frame.settings.ssao
    return {
        "ambient_occlusion": frame[target],
        "occlusion_intensity": ssao.intensity,
        "occlusion_power": ssao.power,
        "occlusion_tint": ssao.tint,
    }
