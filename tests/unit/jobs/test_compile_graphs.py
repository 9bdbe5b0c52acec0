# SPDX-License-Identifier: GPL-3.0-or-later
"""Viewports do not wait for the programs of node graphs, final renders do, and constants need no other programs."""

import threading
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.jobs import compile_graphs
from ism_addon.gpu.jobs.job import Job, Request
from ism_addon.gpu.jobs.render_loop import RenderLoop, draw_job
from ism_addon.gpu.renderer import Renderer
from ism_addon.shading.builder import Builder, constant
from ism_addon.shading.operations import OPERATIONS, Operation
from tests.support.small_scenes import SMALL_SETTINGS, draw, view_from_above, with_quality
from tests.unit.surfaces.test_node_graphs import finished, scene_of

GBUFFER = "passes/surfaces/gbuffer.frag"
#: The color of materials whose programs are not compiled, in the scenes of graphs.
RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def chain(length, *, scale=0.5):
    """A graph of a chain of so many nodes: white times a scale, where normals are along z."""
    builder = Builder(simplify=False)
    value = builder.call("geometry_true_normal")
    for _ in range(length - 2):
        value = builder.call("vector_scale", value, constant(1.0))
    return finished(builder, builder.call("vector_scale", value, constant(scale)))


def scene_of_chains(*lengths, scale=0.5):
    """Squares of graphs that are blue, with red in place of those that are not drawn."""
    scene = scene_of([chain(length, scale=scale) for length in lengths])
    red = np.tile(np.float32(RED), (len(lengths), 1))
    return replace(scene, materials=replace(scene.materials, base_color=red))


def new_job(scene, preview_pixel_size=1, samples=1):
    view = view_from_above(float(len(scene.meshes)), (24, 8))
    settings = with_quality(SMALL_SETTINGS, samples=samples)
    return Job(Request(scene, view, settings, preview_pixel_size=preview_pixel_size), threading.Condition())


@pytest.fixture
def renderers(device):
    """A renderer of pictures and one of previews, without any program."""
    device.forget_programs()
    pair = Renderer(device), Renderer(device)
    yield pair
    for each in pair:
        each.release()


def compiled_graphs(device):
    """How many programs of graphs there are."""
    return sum(GBUFFER in each.sources and dict(each.constants)["graph"] for each in device.programs)


def pictures_of(renderers, job):
    """All pictures of a job that is drawn to its end, and the numbers of programs of graphs before each."""
    shown, counts = [], []
    for _ in draw_job(*renderers, job):
        picture = job.picture()
        if picture is not None and (not shown or picture is not shown[-1]):
            shown.append(picture)
            counts.append(compiled_graphs(renderers[0].device))
    return shown, counts


def is_of(picture, color):
    """Whether light has no other components than a color's."""
    light = picture.color[..., :3].sum((0, 1))
    return bool(((light > 0.0) == (np.array(color) > 0.0)).all())


def test_a_viewport_shows_graphs_in_their_base_color_until_they_are_compiled(device, renderers, monkeypatch):
    monkeypatch.setattr(compile_graphs, "SHOWN_EVERY", 0.0)
    scene = scene_of_chains(3, 4, 5)
    job = new_job(scene)
    pictures, compiled = pictures_of(renderers, job)
    assert compiled == [0, 1, 2, 3]
    assert is_of(pictures[0], RED) and is_of(pictures[-1], BLUE)
    columns = [each.color[..., 2].reshape(8, 3, 8).sum((0, 2)) > 0.0 for each in pictures]
    assert np.array_equal(columns, np.tri(4, 3, -1, dtype=bool)), "one square more with each program"
    assert np.array_equal(pictures[-1].color, draw(device, scene, job.request.view, job.request.settings).color)
    assert [each.samples for each in pictures] == [0, 0, 0, 1]


def test_a_viewport_that_shows_a_picture_keeps_it_for_a_moment(renderers, monkeypatch):
    monkeypatch.setattr(compile_graphs, "PATIENCE", 60.0)
    pictures_of(renderers, new_job(scene_of_chains(3, 4, 5)))
    (picture,), _ = pictures_of(renderers, new_job(scene_of_chains(3, 4, 6)))
    assert is_of(picture, BLUE)


def test_a_final_render_waits_for_all_programs(renderers):
    pictures, compiled = pictures_of(renderers, new_job(scene_of_chains(3, 4, 5), preview_pixel_size=0, samples=2))
    assert all(is_of(each, BLUE) for each in pictures) and set(compiled) == {3}


@pytest.mark.parametrize("preview_pixel_size", [0, 1])
def test_the_status_counts_graphs(device, preview_pixel_size):
    device.forget_programs()
    loop, job, statuses = RenderLoop(device, 0), new_job(scene_of_chains(3, 4, 5), preview_pixel_size), []
    while not job.finished:
        loop.step("client", job)
        if not statuses or job.status != statuses[-1]:
            statuses.append(job.status)
    loop.forget("client")
    started = [] if preview_pixel_size == 0 else ["Sample 0/1"]  # while the picture without graphs is drawn
    expected = [*started, *(f"Compiling shaders ({k} of 3)" for k in (1, 2, 3)), "Sample 0/1", "Sample 1/1"]
    assert statuses == expected


@pytest.mark.parametrize("preview_pixel_size", [0, 1])
def test_a_render_is_cancelled_between_two_programs(device, preview_pixel_size):
    device.forget_programs()
    loop, job = RenderLoop(device, 0), new_job(scene_of_chains(*range(3, 23)), preview_pixel_size)
    while job.graph < 3 and not job.finished:
        loop.step("client", job)
    job.cancel()
    loop.step("client", job)
    assert job.finished and job.error == "" and compiled_graphs(device) == 2
    loop.forget("client")


@pytest.mark.parametrize("preview_pixel_size", [0, 1])
def test_the_constants_of_forty_nodes_need_no_program(renderers, device, preview_pixel_size):
    """What a slider changes: no program is compiled, and the first picture shows the graph."""
    pictures_of(renderers, new_job(scene_of_chains(40, 3), preview_pixel_size))
    known, previous = set(device.programs), None
    for scale in (0.0, 1.0, 0.25):
        pictures, _ = pictures_of(renderers, new_job(scene_of_chains(40, 3, scale=scale), preview_pixel_size))
        assert set(device.programs) == known
        assert is_of(pictures[0], BLUE if scale else (0.0, 0.0, 0.0))
        assert previous is None or not np.array_equal(pictures[-1].color, previous)
        previous = pictures[-1].color


@pytest.mark.parametrize("preview_pixel_size", [0, 1])
def test_a_graph_that_the_driver_refuses_is_drawn_in_its_base_color(renderers, monkeypatch, preview_pixel_size):
    """With one sentence, and with the graphs beside it."""
    monkeypatch.setitem(OPERATIONS, "no_such_function", Operation((), "vec3", "arithmetic"))
    builder = Builder()
    broken = finished(builder, builder.call("no_such_function"))
    red = np.tile(np.float32(RED), (3, 1))
    scene = scene_of([broken, chain(3), broken])
    job = new_job(replace(scene, materials=replace(scene.materials, base_color=red)), preview_pixel_size)
    pictures, _ = pictures_of(renderers, job)
    light = pictures[-1].color[..., :3].reshape(8, 3, 8, 3).sum((0, 2)) > 0.0
    assert light.tolist() == [[True, False, False], [False, False, True], [True, False, False]]
    (warning,) = job.warnings
    assert warning.startswith("The graphics driver cannot compile the nodes of 2 materials, which have one colour: ")
    assert "\n" not in warning
