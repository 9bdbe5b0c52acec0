# SPDX-License-Identifier: GPL-3.0-or-later
"""What shaders need that include surfaces/emission.glsl."""

from typing import Any

import numpy as np

from ....resources import LIGHT_BUFFERS, MATERIAL_BUFFERS, MESH_BUFFERS, POINT_GRAPHS, SEEN_LIGHTS, TRANSMITTED_COLOR
from ...frame import Frame
from ...gl.shader_compiler import Include
from ...gl.shader_records import LIGHT_RECORDS, MATERIAL, Record
from ...lights import mixed_variant
from ...materials.point_graphs import NO_POINT_GRAPHS, PointGraphs
from ...surface_inputs import tint_constants, tint_uniforms

#: Must be among the inputs of their passes.
EMISSION = SEEN_LIGHTS, LIGHT_BUFFERS, MATERIAL_BUFFERS, MESH_BUFFERS, POINT_GRAPHS, TRANSMITTED_COLOR


def emission_parts(frame: Frame) -> tuple[Record | Include, ...]:
    """Records and includes of shaders that include surfaces/emission.glsl."""
    lights = LIGHT_RECORDS if frame.get(SEEN_LIGHTS) is not None else ()
    return *lights, MATERIAL, *emission_graphs(frame).parts


def emission_graphs(frame: Frame) -> PointGraphs:
    """The graphs of surfaces whose emission varies."""
    return (frame.get(POINT_GRAPHS) or NO_POINT_GRAPHS).emission


def emission_constants(frame: Frame) -> dict[str, Any]:
    """Their constants."""
    is_seen = frame.get(SEEN_LIGHTS) is not None
    variant = mixed_variant(frame.scene.lights, seen_rows(frame)) if is_seen else {}
    emissive = int(frame[MATERIAL_BUFFERS].emissive)
    graphs = emission_graphs(frame).constants
    return {"seen_lights": int(is_seen), "emissive": emissive, **variant, **graphs, **tint_constants(frame)}


def emission_uniforms(frame: Frame) -> dict[str, Any]:
    """Their uniforms."""
    seen, uniforms = frame.get(SEEN_LIGHTS), tint_uniforms(frame)
    if frame[MATERIAL_BUFFERS].emissive:
        uniforms |= {"materials": frame[MATERIAL_BUFFERS].table, "corners": frame[MESH_BUFFERS].samplers["corners"]}
        uniforms |= emission_graphs(frame).uniforms
    if seen is not None:
        uniforms |= {**frame[LIGHT_BUFFERS], "seen_lights": seen, "seen_count": len(seen_rows(frame))}
    return uniforms


def seen_rows(frame: Frame) -> list[int]:
    """Indices of the lights that the camera sees."""
    rows: list[int] = np.flatnonzero(frame.scene.lights.visible_camera).tolist()
    return rows
