# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that are one of a few names."""

from enum import StrEnum
from typing import Self


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


class DebugView(Choice):
    """The picture, or any target that a pass writes on the way to it."""

    COLOR = "color", "Picture", "The picture itself"
    TRIANGLE = "triangle", "Triangles", "The nearest triangle, each in a colour of its own"
    DEPTH = "depth", "Depth", "Distance along the view's axis, in metres: white from one on"
    POSITION = "position", "Position", "Place of the nearest surface, in metres, as red, green and blue"
    NORMAL = "normal", "Normal", "Direction of the nearest surface, as red, green and blue"
    ALBEDO = "albedo", "Base Color", "Colour of the nearest surface, without light"
    AROUND = (
        "around",
        "Probe Prediction",
        "The visibility of one light that the probe rays around a pixel predict. Ray Traced only",
    )
    FORESEEN = "foreseen", "Prediction Positions", "Positions that visibility was predicted for. Ray Traced only"
    PREDICTED = "predicted", "Predicted Direct Light", "The lights' irradiance as predicted. Ray Traced only"
    CORRECTION = (
        "correction",
        "Direct Residual",
        "What shadow rays add to the prediction, or take away. Ray Traced only",
    )
    SPLATS = "splats", "Splats", "The shadow maps as the points leave them, with holes. Imperfect Shadow Maps only"
    SHADOW_MAPS = (
        "shadow_maps",
        "Shadow Maps",
        "The shadow maps when their holes are filled. Imperfect Shadow Maps only",
    )
    IRRADIANCE = (
        "irradiance",
        "Irradiance",
        "The lights' irradiance through the shadow maps. Imperfect Shadow Maps only",
    )
    OCCLUSION = "occlusion", "Ambient Occlusion (Raw)", "Ambient occlusion as it is found, with noise: white is open"
    OCCLUSION_ACROSS = (
        "occlusion_across",
        "Ambient Occlusion (Blurred in X)",
        "Ambient occlusion, blurred in rows but not yet in columns",
    )
    SMOOTH_OCCLUSION = "smooth_occlusion", "Ambient Occlusion", "Ambient occlusion as it darkens the picture"
    COLOR_CORRECTION = (
        "color_correction",
        "Residual",
        "What shadow rays add to the render, or take away. Ray Traced only",
    )
    HEADROOM = (
        "headroom",
        "Maximum Increase",
        "How much brighter uncertain light may yet make the render. Ray Traced only",
    )
