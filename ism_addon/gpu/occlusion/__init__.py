# SPDX-License-Identifier: GPL-3.0-or-later
"""Which light ambient occlusion darkens in an image, and whether rays are traced for it."""

from dataclasses import replace

from ...choices import OccludedLight, OcclusionSampling, RadiusUnit
from ...resource_types import Target
from ...resources import DIRECT_PREDICTION, DIRECT_RESIDUAL
from ...resources.world import (
    FILTERED_ONCE,
    OCCLUSION_DISTANCE,
    TRACED_OCCLUSION,
    WORLD_PREDICTION,
    WORLD_RESIDUAL,
)
from ...scene import Lights
from ...settings import Settings
from ...settings.occlusion import SSAO
from ..frame import Frame
from ..lights.world.table import has_world, is_world, world_row

#: The prediction of lights and its correction.
DIRECT = DIRECT_PREDICTION, DIRECT_RESIDUAL
#: The world's prediction and its residual, where occlusion may darken it alone.
SEPARATE_WORLD = WORLD_PREDICTION, WORLD_RESIDUAL


def radius_of(ssao: SSAO) -> float:
    """The radius, in the unit that is chosen."""
    return ssao.radius_pixels if ssao.unit is RadiusUnit.PIXELS else ssao.radius


def look_of(ssao: SSAO) -> SSAO:
    """The settings without those that only count what is open otherwise."""
    return replace(ssao, enabled=True, light=SSAO.light, intensity=1.0, power=1.0, tint=SSAO.tint)


def radius_uniforms(frame: Frame) -> dict[str, float]:
    """Uniforms of occlusion/radius.glsl."""
    ssao = frame.settings.ssao
    in_pixels = ssao.unit is RadiusUnit.PIXELS
    return {
        "radius_meters": 0.0 if in_pixels else ssao.radius,
        "radius_pixels": ssao.radius_pixels if in_pixels else 0.0,
    }


def has_ambient_light(frame: Frame) -> bool:
    """Whether the world lights surfaces without being one of the lights."""
    return bool(frame.scene.world.radiance.any()) and not has_world(frame.scene.lights)


def has_unshadowed_world(lights: Lights) -> bool:
    """Whether the world is a light without shadows."""
    return has_world(lights) and not lights.casts_shadow[world_row(lights)]


def darkens(frame: Frame) -> bool:
    """Whether the image would differ without ambient occlusion."""
    ssao, lights = frame.settings.ssao, frame.scene.lights
    if not (ssao.enabled and ssao.intensity > 0.0 and min(ssao.tint) < 1.0):
        return False
    with_shadows = {
        OccludedLight.UNSHADOWED: has_unshadowed_world(lights),
        OccludedLight.WORLD: has_world(lights),
        OccludedLight.ALL: len(lights.shape) > 0,
    }
    return with_shadows[ssao.light] or has_ambient_light(frame)


def is_needed(frame: Frame) -> bool:
    """Whether ambient occlusion is drawn: for the image, or for the render pass AO."""
    return radius_of(frame.settings.ssao) > 0.0 and (frame.settings.occlusion_pass or darkens(frame))


def separates_world(frame: Frame) -> bool:
    """Whether the world is one of the lights, but drawn apart from them, as occlusion may darken it alone."""
    return may_darken_world_alone(frame.settings.ssao, frame.scene.lights)


def may_darken_world_alone(ssao: SSAO, lights: Lights) -> bool:
    """Whether occlusion may darken the world, and it is one of these lights."""
    darkens_alone = {
        OccludedLight.UNSHADOWED: has_unshadowed_world(lights),
        OccludedLight.WORLD: has_world(lights),
        OccludedLight.ALL: False,
    }
    return darkens_alone[ssao.light]


def targets_of(frame: Frame, light: int) -> tuple[Target, Target]:
    """Where the prediction of a light and its correction are drawn."""
    return SEPARATE_WORLD if separates_world(frame) and is_world(frame.scene.lights)[light] else DIRECT


def unused_targets(settings: Settings, lights: Lights) -> set[Target]:
    """Targets that ambient occlusion does not need with these settings and lights."""
    ssao, unused = settings.ssao, set[Target]()
    if ssao.sampling is not OcclusionSampling.TRACED:
        unused |= {OCCLUSION_DISTANCE, FILTERED_ONCE, TRACED_OCCLUSION}
    if not may_darken_world_alone(ssao, lights):
        unused |= set(SEPARATE_WORLD)
    return unused


def may_trace_occlusion(settings: Settings) -> bool:
    """Whether rays are traced for ambient occlusion in some scene, with some radius and intensity."""
    ssao = settings.ssao
    return ssao.sampling is OcclusionSampling.TRACED and (ssao.enabled or settings.occlusion_pass)


def traces_occlusion(frame: Frame) -> bool:
    """Whether rays are traced for ambient occlusion that can hit anything."""
    has_casters = bool(frame.scene.instances.casts_shadow.any())
    return may_trace_occlusion(frame.settings) and is_needed(frame) and has_casters


def traces_rays(frame: Frame) -> bool:
    """Whether any rays are traced that can hit anything, which needs acceleration structures."""
    return frame.traces_shadows or traces_occlusion(frame) or frame.scene.traces_graphs
