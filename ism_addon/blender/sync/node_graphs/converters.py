# SPDX-License-Identifier: GPL-3.0-or-later
"""All converters of nodes, by the nodes' type."""

from . import (
    color_nodes,
    input_nodes,
    normal_nodes,
    pattern_nodes,
    procedural_nodes,
    shader_nodes,
    texture_nodes,
    value_nodes,
)

CONVERTERS = {
    **value_nodes.CONVERTERS,
    **color_nodes.CONVERTERS,
    **texture_nodes.CONVERTERS,
    **procedural_nodes.CONVERTERS,
    **pattern_nodes.CONVERTERS,
    **input_nodes.CONVERTERS,
    **normal_nodes.CONVERTERS,
    **shader_nodes.CONVERTERS,
}
