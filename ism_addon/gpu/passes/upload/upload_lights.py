# SPDX-License-Identifier: GPL-3.0-or-later
"""The area lights as shaders read them."""

import numpy as np

from .... import scene
from ....radiometry import plane_normals, spread_terms
from ....resources import LIGHT_BUFFER
from ....scene import Change
from ....spaces import orthonormal
from ...frame import Frame, Pass, outputs
from ...gl.shader_records import LIGHT


def light_table(lights: scene.Lights, anchor: np.ndarray) -> np.ndarray:
    """Rows (L,) of LIGHT."""
    normals = plane_normals(lights)
    table = np.zeros(len(normals), LIGHT.dtype)
    table["position"], table["normal"], table["tangent"] = lights.position - anchor, normals, orthonormal(normals)[0]
    for name in ("shape", "axis_u", "axis_v", "casts_shadow", "radiance", "receivers", "blockers"):
        table[name] = getattr(lights, name)
    table["spread_tangent"], table["spread_scale"] = spread_terms(lights.spread).T
    return table


class UploadLights(Pass):
    """The table of lights."""

    inputs = (Change.LIGHTS,)
    outputs = outputs(LIGHT_BUFFER)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        table = light_table(frame.scene.lights, frame.anchor)
        frame[LIGHT_BUFFER] = LIGHT.upload(self.device, table)
        frame.counts["bytes_uploaded"] += table.nbytes
