# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of shaders that include surfaces/receiver_linking.glsl, visible_triangle.glsl or tint.glsl."""

from typing import Any

from ..resource_types import Resource
from ..resources import (
    INSTANCE_BUFFERS,
    NORMAL,
    POSITION,
    PRIMITIVE,
    TERMINATOR_OFFSET,
    TRANSMITTED_COLOR,
    VISIBILITY_BUFFER,
)
from .frame import Frame

#: Must be among the inputs of their passes.
SURFACE: tuple[Resource[Any], ...] = POSITION, NORMAL, PRIMITIVE, TERMINATOR_OFFSET, INSTANCE_BUFFERS


def surface_samplers(frame: Frame) -> dict[str, Any]:
    """Samplers by name. The base color is an input only of passes that declare MATERIAL."""
    return {
        "position": frame[POSITION],
        "normal": frame[NORMAL],
        "base_color": frame[TERMINATOR_OFFSET],
        "link_groups": frame[INSTANCE_BUFFERS].memberships,
    }


def fine_pixel_uniforms(frame: Frame) -> dict[str, Any]:
    """Uniforms of textures/fine_pixel.glsl."""
    first, size = frame.grid.bounds(*frame.size)
    fine_from_pixel = tuple(frame.grid.fine_from_pixel.T.ravel())
    return {"fine_from_pixel": fine_from_pixel, "first": tuple(first), "last": tuple(size - 1)}


def visible_triangle_uniforms(frame: Frame) -> dict[str, Any]:
    """Uniforms of surfaces/visible_triangle.glsl. VISIBILITY_BUFFER must be among the inputs of their passes."""
    return {"visibility_buffer": frame[VISIBILITY_BUFFER], **fine_pixel_uniforms(frame)}


def tint_constants(frame: Frame) -> dict[str, int]:
    """Constants of shaders that include surfaces/tint.glsl."""
    return {"tinted": int(not frame.is_neutral(TRANSMITTED_COLOR))}


def tint_uniforms(frame: Frame) -> dict[str, Any]:
    """Their uniforms. TRANSMITTED_COLOR must be among the inputs of their passes."""
    if frame.is_neutral(TRANSMITTED_COLOR):
        return {}
    return {"transmitted_color": frame[TRANSMITTED_COLOR], **fine_pixel_uniforms(frame)}
