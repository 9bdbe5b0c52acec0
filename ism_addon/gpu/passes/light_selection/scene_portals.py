# SPDX-License-Identifier: GPL-3.0-or-later
"""Portals on the GPU, and what shaders need to sample a light through them."""

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from ....resources import PROBE
from ....resources.world import PORTALS
from ...culling.portals import Portals
from ...frame import Frame
from ...gl.buffer_texture import RecordTable, SceneRecords
from ...gl.shader_records import LIGHT

#: As PROBE, of a light that is sampled through portals: a ray may count for more or less than one.
WEIGHTED_PROBE = replace(PROBE, format="rg16f")


@dataclass(frozen=True)
class ScenePortals:
    """Portals of the world."""

    light: int  # the world's row in the table of lights
    shape: int  # its
    portals: Portals
    table: RecordTable  # rows of LIGHT: rectangles like area lights

    @classmethod
    def upload(cls, records: SceneRecords, light: int, shape: int, portals: Portals) -> Self:
        """Write them into the scene's records."""
        return cls(light, shape, portals, LIGHT.write(records, "portals", light_table(portals)))

    @property
    def constants(self) -> dict[str, int]:
        """Constants of shaders that sample the world."""
        return {"portals": self.shape}

    @property
    def uniforms(self) -> dict[str, Any]:
        """Uniforms of lights/portals.glsl."""
        return {
            "portals": self.table,
            "portal_count": len(self.portals.rectangles),
            "portal_probability": self.portals.probability,
            "portal_moments": self.portals.moments,
            "importance_beside": self.portals.importance_beside,
        }


def portals_of(frame: Frame, light: int) -> ScenePortals | None:
    """The portals that a light is sampled through, if any. PORTALS is an input of the pass."""
    portals = frame.get(PORTALS)
    return portals if portals and portals.light == light else None


def light_table(portals: Portals) -> np.ndarray:
    """Rows (K,) of LIGHT."""
    table = np.zeros(len(portals.rectangles), LIGHT.dtype)
    for row, each in zip(table, portals.rectangles, strict=True):
        row["position"], row["normal"], (row["axis_u"], row["axis_v"]) = each.centre, each.normal, each.sides
    return table
