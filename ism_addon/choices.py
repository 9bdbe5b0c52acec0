# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings with a fixed set of values."""

from enum import StrEnum
from typing import Self

from . import resources
from .resource_types import Channel, Target


class Choice(StrEnum):
    """A setting with a fixed set of values. Each has a label and a meaning, shown to the user."""

    label: str
    meaning: str

    def __new__(cls, value: str, label: str, meaning: str) -> Self:
        member = str.__new__(cls, value)
        member._value_ = value
        member.label, member.meaning = label, meaning
        return member


class Method(Choice):
    """How shadows are computed."""

    RAY_TRACED = (
        "RAY_TRACED",
        "Ray Traced",
        "Shadow rays where a prediction is uncertain. Converges to the exact result",
    )
    SHADOW_MAPS = (
        "SHADOW_MAPS",
        "Imperfect Shadow Maps",
        "A shadow map for each virtual point light, as in the report of 2013. Never exact",
    )


class OcclusionSampling(Choice):
    """How surfaces that darken others are found."""

    HORIZONS = (
        "HORIZONS",
        "Horizons",
        "How high the surfaces around rise on the screen. Near to what rays of the same radius find",
    )
    POINTS = (
        "POINTS",
        "Points",
        "Points around the surface, compared with the screen, as in the report of 2013. About a third as dark, "
        "except in narrow creases",
    )
    TRACED = (
        "TRACED",
        "Ray Traced",
        "A ray in each pixel and sample, filtered. Exact in the end, also for what the camera does not see; takes "
        "longer. Changes of radius, intensity and attenuation trace no new rays",
    )


class OccludedLight(Choice):
    """Which light ambient occlusion darkens."""

    UNSHADOWED = (
        "UNSHADOWED",
        "Unshadowed World",
        "The world's light where no shadow rays are traced to the world: occlusion stands for its shadows",
    )
    WORLD = (
        "WORLD",
        "World",
        "The world's light. With World Shadows, surfaces are darker in creases than they are in reality",
    )
    ALL = "ALL", "All Lights", "The light of the world and of all lights. Creases are darker than they are in reality"


class RadiusUnit(Choice):
    """In what the radius of ambient occlusion is measured."""

    METERS = "METERS", "Meters", "The same on all surfaces"
    PIXELS = "PIXELS", "Pixels", "The same in the picture: larger on surfaces far away"


class Resolution(Choice):
    """Width and height of what the viewport draws, in percent of the viewport."""

    FULL = "100", "100 %", "Render at full resolution"
    HALF = "50", "50 %", "Render at half width and height"
    QUARTER = "25", "25 %", "Render at a quarter of the width and height"


def _view(target: Target | Channel) -> tuple[str, str, str]:
    return target.name, target.label, target.about


class DebugView(Choice):
    """The render, or any render target that has a label."""

    SAMPLE_COLOR = _view(resources.SAMPLE_COLOR)
    PRIMITIVE = _view(resources.PRIMITIVE)
    DEPTH = _view(resources.DEPTH)
    POSITION = _view(resources.POSITION)
    NORMAL = _view(resources.NORMAL)
    BASE_COLOR = _view(resources.BASE_COLOR)
    PROBE_PREDICTION = _view(resources.PROBE_PREDICTION)
    PREDICTION_SURFACE = _view(resources.PREDICTION_SURFACE)
    DIRECT_PREDICTION = _view(resources.DIRECT_PREDICTION)
    DIRECT_RESIDUAL = _view(resources.DIRECT_RESIDUAL)
    SHADOW_MAP_SPLATS = _view(resources.SHADOW_MAP_SPLATS)
    SHADOW_MAPS = _view(resources.SHADOW_MAPS)
    RAW_OCCLUSION = _view(resources.world.RAW_OCCLUSION)
    HALF_BLURRED_OCCLUSION = _view(resources.world.HALF_BLURRED_OCCLUSION)
    AMBIENT_OCCLUSION = _view(resources.world.AMBIENT_OCCLUSION)
    OCCLUSION_DISTANCE = _view(resources.world.OCCLUSION_DISTANCE)
    TRACED_OCCLUSION = _view(resources.world.TRACED_OCCLUSION)
    SAMPLE_RESIDUAL = _view(resources.SAMPLE_RESIDUAL)
    SAMPLE_HEADROOM = _view(resources.SAMPLE_HEADROOM)
    SAMPLE_EMISSION = _view(resources.SAMPLE_EMISSION)
