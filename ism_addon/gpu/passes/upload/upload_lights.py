# SPDX-License-Identifier: GPL-3.0-or-later
"""Upload the lights as shader records."""

import numpy as np

from ....resources import LIGHT_BUFFERS, SEEN_LIGHTS
from ....resources.world import BAKED_WORLD
from ....scene import Change, Lights
from ...emission.emissive_lights import EmissiveLights
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.buffer_texture import RecordTable, SceneRecords
from ...gl.shader_records import EMISSIVE_COLOR, EMISSIVE_TRIANGLE, LIGHT, LIGHT_NODE, LIGHT_NODE_COLOR
from ...lights import by_type
from ...lights.world.table import ENVIRONMENT, MAP_SUN
from .light_textures import NO_TEXTURES, LightTextures


def light_table(lights: Lights, anchor: np.ndarray, textures: LightTextures) -> np.ndarray:
    """Rows (L,) of LIGHT."""
    table = np.zeros(len(lights.shape), LIGHT.dtype)
    for light_type, rows, type_lights in by_type(lights):
        table[rows] = light_type.records(type_lights, anchor)
    textures.refer(table, lights)
    return table


def node_table(lights: EmissiveLights, anchor: np.ndarray) -> np.ndarray:
    """Rows (N,) of LIGHT_NODE."""
    nodes = np.zeros(len(lights.node_area), LIGHT_NODE.dtype)
    nodes["centre"] = lights.node_centre - anchor
    for name in ("radius", "normal", "area", "normal_sine", "one_sided"):
        nodes[name] = getattr(lights, f"node_{name}")
    for name in ("normal", "position"):
        elements = getattr(lights, f"node_{name}_{name}")
        nodes[f"{name}_squares"], nodes[f"{name}_products"] = elements[:, :3], elements[:, 3:]
    for axis, row in zip("xyz", np.hsplit(lights.node_normal_position, 3), strict=True):
        nodes[f"normal_{axis}_position"] = row
    return nodes


def triangle_table(lights: EmissiveLights, anchor: np.ndarray) -> np.ndarray:
    """Rows (T,) of EMISSIVE_TRIANGLE."""
    triangles, corners = np.zeros(len(lights.corners), EMISSIVE_TRIANGLE.dtype), lights.corners - anchor
    triangles["corner"], triangles["one_sided"] = corners[:, 0], lights.one_sided
    triangles["u"], triangles["v"] = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return triangles


def color_tables(records: SceneRecords, lights: EmissiveLights) -> dict[str, RecordTable]:
    """Write what triangles differ in from their lights, and nodes of light BVHs."""
    colors, of_nodes = (
        np.zeros(len(rows), record.dtype)
        for rows, record in ((lights.colors, EMISSIVE_COLOR), (lights.node_color, LIGHT_NODE_COLOR))
    )
    colors["color"], colors["luminance"] = lights.colors[:, :3], lights.colors[:, 3]
    of_nodes["color"] = lights.node_color
    return {
        "emissive_colors": EMISSIVE_COLOR.write(records, "emissive_colors", colors),
        "light_node_colors": LIGHT_NODE_COLOR.write(records, "light_node_colors", of_nodes),
    }


def light_buffers(
    records: SceneRecords, lights: Lights, anchor: np.ndarray, textures: LightTextures = NO_TEXTURES
) -> dict[str, RecordTable]:
    """Write the tables of lights, of their textures, and of emissive meshes if there are any. Returns them by name."""
    tables = {
        "lights": LIGHT.write(records, "lights", light_table(lights, anchor, textures)),
        "light_texels": records.write("light_texels", textures.words, 1),
    }
    if isinstance(lights, EmissiveLights):
        tables["light_nodes"] = LIGHT_NODE.write(records, "light_nodes", node_table(lights, anchor))
        triangles = triangle_table(lights, anchor)
        tables["emissive_triangles"] = EMISSIVE_TRIANGLE.write(records, "emissive_triangles", triangles)
        if len(lights.colors):
            tables |= color_tables(records, lights)
    return tables


class UploadLights(Pass):
    """Upload the lights, and those that the camera sees once more."""

    schedule = Schedule.FIRST
    inputs = Change.LIGHTS, BAKED_WORLD
    outputs = outputs(LIGHT_BUFFERS, SEEN_LIGHTS)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        lights, records = frame.scene.lights, frame.scene_records
        textures = LightTextures.of(frame.scene.light_profiles, frame.scene.light_images)
        tables = light_buffers(records, lights, frame.anchor, textures)
        frame[LIGHT_BUFFERS] = tables | (
            frame[BAKED_WORLD].uniforms if np.isin(lights.shape, (ENVIRONMENT, MAP_SUN)).any() else {}
        )
        seen = lights.select(lights.visible_camera)
        seen_table = light_table(seen, frame.anchor, textures)
        frame[SEEN_LIGHTS] = LIGHT.write(records, "seen_lights", seen_table) if len(seen.shape) else None
        frame.counts["bytes_uploaded"] += sum(table.bytes for table in tables.values())
