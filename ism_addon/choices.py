# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that are one of a few names."""

from enum import StrEnum
from typing import Self

from . import resources
from .resource_types import Target


class Choice(StrEnum):
    """A setting of a few names. Each has a label and a meaning for its user."""

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


class Resolution(Choice):
    """The side of the viewport's picture, in percent of the viewport's."""

    FULL = "100", "100 %", "Draw each pixel"
    HALF = "50", "50 %", "Draw a quarter of the pixels, each twice as wide and high"
    QUARTER = "25", "25 %", "Draw a sixteenth of the pixels, each four times as wide and high"


def _view(target: Target) -> tuple[str, str, str]:
    return target.name, target.label, target.about


class DebugView(Choice):
    """The render, or any target with a label that a pass makes on the way to it."""

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
    RAW_OCCLUSION = _view(resources.RAW_OCCLUSION)
    HALF_BLURRED_OCCLUSION = _view(resources.HALF_BLURRED_OCCLUSION)
    AMBIENT_OCCLUSION = _view(resources.AMBIENT_OCCLUSION)
    SAMPLE_RESIDUAL = _view(resources.SAMPLE_RESIDUAL)
    SAMPLE_HEADROOM = _view(resources.SAMPLE_HEADROOM)
