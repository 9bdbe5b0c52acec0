# SPDX-License-Identifier: GPL-3.0-or-later
"""Compiles the programs of node graphs before a picture is drawn, one graph after the other.

A viewport shows its old picture for a moment, and then materials whose programs are not compiled in one color. Drivers
compile a program when it is linked, when it is first drawn, or both. So it counts as compiled once it has drawn a small
picture of the surfaces.
"""

import time
from collections.abc import Callable, Iterator

import numpy as np

from ...scene import Scene
from ..buffers.texture_buffer import image_constants
from ..gl.context import Device
from ..materials.shader import material_shader
from ..passes.surfaces.gbuffer import sources
from ..profile import Profile
from ..renderer import Renderer
from .job import Job

#: Seconds for which a viewport goes on showing its old picture, as a single program takes less to compile.
PATIENCE = 0.25
#: Minimum of seconds between pictures that show the materials compiled so far.
SHOWN_EVERY = 2.0
#: Width of the small picture's pixels, in pixels of a final render.
PIXEL_SIZE = 8


def compile_graphs(
    renderer: Renderer, job: Job, cancelled: Callable[[], bool], preview: Callable[[Scene, Profile], Iterator[None]]
) -> Iterator[None]:
    """Compile what is not compiled yet of a job's scene; yields after each pass. Raises Cancelled.

    `preview` draws a preview of a scene. Requests without a preview wait for all programs.
    """
    request, used = job.request, used_graphs(job.request.scene)
    pending = [graph for graph in used if not is_compiled(renderer.device, request.scene, graph)]
    view = request.view.with_larger_pixels(request.preview_pixel_size or PIXEL_SIZE)
    shown_at, wait = time.perf_counter(), PATIENCE if renderer.has_drawn else 0.0
    for index, graph in enumerate(pending):
        if request.preview_pixel_size > 0 and time.perf_counter() - shown_at >= wait:
            yield from preview(request.scene.without_graphs(pending[index:]), Profile())
            shown_at, wait = time.perf_counter(), SHOWN_EVERY
        job.begin_graph(index + 1, len(pending))
        alone = request.scene.without_graphs([each for each in used if each != graph])
        for _ in renderer.surfaces(alone, view, request.settings, Profile(), cancelled):
            yield
    if pending:
        job.begin_graph(0, 0)


def used_graphs(scene: Scene) -> list[int]:
    """Indices of the graphs that any material has."""
    graphs: list[int] = np.unique(scene.materials.graph[scene.materials.graph >= 0]).tolist()
    return graphs


def is_compiled(device: Device, scene: Scene, graph: int) -> bool:
    """Whether the programs of a graph are compiled, or cannot be."""
    shader = material_shader(scene.materials, scene.graphs, image_constants(scene.images), graph)
    return all(source in device.programs for source in sources(scene, shader))
