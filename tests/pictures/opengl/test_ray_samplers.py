# SPDX-License-Identifier: GPL-3.0-or-later
"""Samplers of the shaders that trace rays: of the 16 that OpenGL 4.1 guarantees, some must be left for materials."""

from dataclasses import replace
from pathlib import Path

import moderngl
import numpy as np

from tests.scenes.lights.mixed_rooms import mixed_rooms, with_emitters
from tests.support.small_scenes import SMALL_SETTINGS, draw, with_quality
from tests.tools.glslang import SAMPLER_TYPES

#: The most samplers of a shader's variants. Another table needs none if it is in SceneRecords, see buffer_texture.py.
MAX_SAMPLERS = {"probe_rays": 7, "trace_shadows": 9, "trace_shadows_faint": 6}


def samplers_of(program: moderngl.Program) -> set[str]:
    """Names of the samplers that a linked program uses."""
    members = (program[name] for name in program)
    return {each.name for each in members if isinstance(each, moderngl.Uniform) and each.gl_type in SAMPLER_TYPES}


def test_shaders_that_trace_rays_leave_samplers_for_materials(device):
    """To lights of all types, linked ones too, and an emissive mesh whose irradiance cache has each pixel near it."""
    scene, view = mixed_rooms(0, 64, 48)
    receivers = np.where(np.arange(len(scene.lights.shape)) % 2, 0, -1).astype(np.int32)
    linked = replace(scene, lights=replace(scene.lights, receivers=receivers))
    scene = with_emitters(linked, [np.array([4.0, 2.5, 0.4])])
    device.forget_programs()
    draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=5))
    samplers: dict[str, list[set[str]]] = {}
    for (sources, *_), program in device.programs.items():
        if "blas_nodes" in (names := samplers_of(program)):
            samplers.setdefault(Path(sources[-1]).stem, []).append(names)
    assert samplers.keys() == MAX_SAMPLERS.keys()
    assert any("irradiance_ratio" in names for names in samplers["trace_shadows"])
    assert {name: max(map(len, variants)) for name, variants in samplers.items()} == MAX_SAMPLERS, samplers
