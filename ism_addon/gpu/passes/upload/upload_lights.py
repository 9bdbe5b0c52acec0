# SPDX-License-Identifier: GPL-3.0-or-later
"""Upload the lights as shader records."""

import numpy as np

from ....resources import LIGHT_BUFFERS, SEEN_LIGHTS
from ....scene import Change, Lights
from ...emission.emissive_lights import EmissiveLights
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.buffer_texture import BufferTexture
from ...gl.context import Device
from ...gl.shader_records import EMISSIVE_TRIANGLE, LIGHT, LIGHT_NODE
from ...lights import by_type
from ...lights.emissive_mesh import padded_nodes
from .light_textures import NO_TEXTURES, LightTextures


def light_table(lights: Lights, anchor: np.ndarray, textures: LightTextures) -> np.ndarray:
    """Rows (L,) of LIGHT."""
    table = np.zeros(len(lights.shape), LIGHT.dtype)
    for light_type, rows, type_lights in by_type(lights):
        table[rows] = light_type.records(type_lights, anchor)
    textures.refer(table, lights)
    return table


def emitter_words(lights: EmissiveLights, anchor: np.ndarray) -> np.ndarray:
    """Rows of LIGHT_NODE, and after padded_nodes of these rows of EMISSIVE_TRIANGLE, as words."""
    nodes = np.zeros(padded_nodes(lights), LIGHT_NODE.dtype)
    used = nodes[: len(lights.node_area)]
    used["centre"] = lights.node_centre - anchor
    for name in ("radius", "normal", "area", "normal_sine", "one_sided"):
        used[name] = getattr(lights, f"node_{name}")
    for name in ("normal", "position"):
        elements = getattr(lights, f"node_{name}_{name}")
        used[f"{name}_squares"], used[f"{name}_products"] = elements[:, :3], elements[:, 3:]
    for axis, row in zip("xyz", np.hsplit(lights.node_normal_position, 3), strict=True):
        used[f"normal_{axis}_position"] = row
    triangles, corners = np.zeros(len(lights.corners), EMISSIVE_TRIANGLE.dtype), lights.corners - anchor
    triangles["corner"], triangles["one_sided"] = corners[:, 0], lights.one_sided
    triangles["u"], triangles["v"] = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.concatenate([LIGHT_NODE.words(nodes), EMISSIVE_TRIANGLE.words(triangles)])


def light_buffers(
    device: Device, lights: Lights, anchor: np.ndarray, textures: LightTextures = NO_TEXTURES
) -> dict[str, BufferTexture]:
    """The table of lights with their textures, and that of emitters if there are any, by sampler name."""
    table = LIGHT.words(light_table(lights, anchor, textures))
    buffers = {"lights": device.buffer_from(np.concatenate([table, textures.words]))}
    if isinstance(lights, EmissiveLights):
        buffers["emitters"] = device.buffer_from(emitter_words(lights, anchor))
    return buffers


class UploadLights(Pass):
    """Upload the lights, and those that the camera sees once more."""

    schedule = Schedule.FIRST
    inputs = (Change.LIGHTS,)
    outputs = outputs(LIGHT_BUFFERS, SEEN_LIGHTS)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        lights = frame.scene.lights
        first_texel = len(lights.shape) * LIGHT.texels
        textures = LightTextures.of(frame.scene.light_profiles, frame.scene.light_images, first_texel)
        frame[LIGHT_BUFFERS] = buffers = light_buffers(self.device, lights, frame.anchor, textures)
        seen = lights.select(lights.visible_camera)
        seen_table = light_table(seen, frame.anchor, textures)
        frame[SEEN_LIGHTS] = LIGHT.upload(self.device, seen_table) if len(seen.shape) else None
        frame.counts["bytes_uploaded"] += sum(buffer.bytes for buffer in buffers.values())
