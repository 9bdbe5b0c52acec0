# SPDX-License-Identifier: GPL-3.0-or-later
"""A diffuse material of one color, which may emit."""

from collections.abc import Sequence

import bpy


def make_diffuse(
    material: bpy.types.Material, color: Sequence[float], emission: Sequence[float], strength: float
) -> None:
    """Replace a material's nodes. Colors have three components; without a strength, it does not emit."""
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled" if strength else "ShaderNodeBsdfDiffuse")
    tree.links.new(shader.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    shader.inputs[0].default_value = (*color, 1.0)
    if strength:
        shader.inputs["Specular IOR Level"].default_value = 0.0
        shader.inputs["Roughness"].default_value = 1.0
        shader.inputs["Emission Color"].default_value = (*emission, 1.0)
        shader.inputs["Emission Strength"].default_value = strength
