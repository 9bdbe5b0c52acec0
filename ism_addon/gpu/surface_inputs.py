# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of shaders that include surfaces/receiver_linking.glsl."""

from typing import Any

from ..resource_types import Resource
from ..resources import INSTANCE_BUFFERS, NORMAL, POSITION, PRIMITIVE, TERMINATOR_OFFSET
from .frame import Frame

#: Must be among the inputs of their passes.
SURFACE: tuple[Resource[Any], ...] = POSITION, NORMAL, PRIMITIVE, TERMINATOR_OFFSET, INSTANCE_BUFFERS


def surface_samplers(frame: Frame) -> dict[str, Any]:
    """Samplers by name. The base color is an input only of passes that declare MATERIAL."""
    return {
        "position": frame[POSITION],
        "normal": frame[NORMAL],
        "primitive": frame[PRIMITIVE],
        "base_color": frame[TERMINATOR_OFFSET],
        "link_groups": frame[INSTANCE_BUFFERS].memberships,
    }
