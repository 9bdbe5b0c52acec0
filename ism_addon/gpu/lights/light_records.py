# SPDX-License-Identifier: GPL-3.0-or-later
"""What the records of all types of light have in common."""

import numpy as np

from ...scene import Lights
from ..gl.shader_records import LIGHT

#: Fields of Lights that LIGHT has as they are.
COMMON = (
    "shape",
    "casts_shadow",
    "shadow_softness",
    "emission",
    "receivers",
    "blockers",
    "falloff_power",
    "falloff_smooth",
)


def light_records(lights: Lights, anchor: np.ndarray, *fields: str) -> np.ndarray:
    """Rows (L,) of LIGHT about the anchor (3,) m, with these fields of Lights and those in common."""
    table = np.zeros(len(lights.shape), LIGHT.dtype)
    table["position"] = lights.position - anchor
    for name in (*COMMON, *fields):
        table[name] = getattr(lights, name)
    table["profile_x"], table["profile_y"], table["profile_down"] = lights.profile_axes.swapaxes(0, 1)
    return table
