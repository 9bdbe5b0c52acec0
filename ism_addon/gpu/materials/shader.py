# SPDX-License-Identifier: GPL-3.0-or-later
"""The shaders that draw materials: one for each graph, and one for all materials without a graph."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

from ...resources import GRAPH_CELLS
from ...scene import Materials, NodeGraph
from ..gl.shader_compiler import Include
from . import compiler

#: The same text for the same graph: a text as long is compared soonest with itself.
glsl = lru_cache(maxsize=None)(compiler.glsl)


class MaterialShader(NamedTuple):
    """The parts of a shader that draws the materials of one graph."""

    includes: tuple[Include, ...]
    constants: dict[str, Any]
    has_graph: bool
    traces_rays: bool
    has_gloss: bool
    has_coat: bool
    has_layers: bool  # lobes that few scenes have
    reads_images: bool
    reads_uvs: bool
    reads_attributes: bool
    reads_objects: bool
    reads_instance_attributes: bool


def has_several_graphs(materials: Materials, graphs: tuple[NodeGraph, ...]) -> bool:
    """Whether several shaders draw the materials; also of a scene of the same graphs, some of which no material has."""
    return sum(graph.reflects for graph in graphs) + bool((materials.graph < 0).any()) > 1


def material_shader(
    materials: Materials, graphs: tuple[NodeGraph, ...], image_constants: Mapping[str, int], graph: int
) -> MaterialShader:
    """What draws the materials of a graph, or for -1 of none. `image_constants`: see TextureBuffer."""
    own = graphs[graph] if graph >= 0 else None
    reads_images = bool((materials.image[materials.graph < 0] >= 0).any()) if own is None else own.uses("image")
    has_gloss = own is not None and own.has_gloss
    return MaterialShader(
        includes=() if own is None else (glsl(own),),
        constants={
            "graph": int(own is not None),
            "glossy": int(has_gloss),
            "bumps": 0 if own is None else own.bump_shadowing,
            **({"graph_cells": GRAPH_CELLS} if has_several_graphs(materials, graphs) else {}),
            "images": int(reads_images),
            **({"traces_nodes": 1, "transparency": 0} if own is not None and own.traces_rays else {}),
            **(image_constants if reads_images else {}),
        },
        has_graph=own is not None,
        traces_rays=own is not None and own.traces_rays,
        has_gloss=has_gloss,
        has_coat=own is not None and own.has_coat,
        has_layers=own is not None and (own.has_coat or own.has_extra),
        reads_images=reads_images,
        reads_uvs=reads_images if own is None else own.uses("uv_map"),
        reads_attributes=own is not None and own.uses("mesh_attribute"),
        reads_objects=own is not None and own.reads_objects,
        reads_instance_attributes=own is not None and own.uses("instance_attribute"),
    )
