# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that are one of a few names."""

from enum import StrEnum
from typing import Self

from .resources import DEBUG_VIEWS


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


DebugView = Choice(  # type: ignore[call-overload]
    "DebugView", [(view.name.upper(), (view.name, view.label, view.about)) for view in DEBUG_VIEWS]
)
DebugView.__doc__ = "The render, or any target that a pass makes on the way to it."
