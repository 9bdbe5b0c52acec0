# SPDX-License-Identifier: GPL-3.0-or-later
"""Upload the lights as shader records."""

import numpy as np

from ....resources import LIGHT_BUFFER, SEEN_LIGHTS
from ....scene import Change, Lights
from ...frame import Frame, Pass, outputs
from ...gl.shader_records import LIGHT
from ...lights import by_type


def light_table(lights: Lights, anchor: np.ndarray) -> np.ndarray:
    """Rows (L,) of LIGHT."""
    table = np.zeros(len(lights.shape), LIGHT.dtype)
    for light_type, rows, type_lights in by_type(lights):
        table[rows] = light_type.records(type_lights, anchor)
    return table


class UploadLights(Pass):
    """Upload the table of lights."""

    inputs = (Change.LIGHTS,)
    outputs = outputs(LIGHT_BUFFER, SEEN_LIGHTS)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        table = light_table(frame.scene.lights, frame.anchor)
        frame[LIGHT_BUFFER] = LIGHT.upload(self.device, table)
        seen = table[frame.scene.lights.visible_camera]
        frame[SEEN_LIGHTS] = LIGHT.upload(self.device, seen) if len(seen) else None
        frame.counts["bytes_uploaded"] += table.nbytes
