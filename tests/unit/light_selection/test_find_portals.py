# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms with windows: the world is sampled through them, which changes no mean; elsewhere nothing is traced for it."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.culling import portals
from ism_addon.gpu.gl.render_targets import pixels
from ism_addon.gpu.passes.light_selection import find_portals
from ism_addon.resources import RAY_COUNTS
from ism_addon.resources.world import PORTALS
from ism_addon.settings import Shadow
from ism_addon.shading.builder import Builder, constant
from tests.support.small_scenes import SMALL_SETTINGS, draw, light, look_at, make_scene, quad, with_quality

SETTINGS = replace(SMALL_SETTINGS, shadow=Shadow(world=True))
#: A room of 4×5×2.6 m. Its wall at x = -2 has a window of 1.2×0.9 m.
CLOSED = (
    quad((-2, -2.5, 0), (4, 0, 0), (0, 5, 0)),
    quad((-2, -2.5, 2.6), (4, 0, 0), (0, 5, 0)),
    quad((2, -2.5, 0), (0, 5, 0), (0, 0, 2.6)),
    quad((-2, -2.5, 0), (4, 0, 0), (0, 0, 2.6)),
    quad((-2, 2.5, 0), (4, 0, 0), (0, 0, 2.6)),
)
WALL = (
    quad((-2, -2.5, 0), (0, 5, 0), (0, 0, 1.0)),
    quad((-2, -2.5, 1.9), (0, 5, 0), (0, 0, 0.7)),
    quad((-2, -2.5, 1.0), (0, 2.0, 0), (0, 0, 0.9)),
    quad((-2, 0.7, 1.0), (0, 1.8, 0), (0, 0, 0.9)),
)
TABLE = quad((-0.8, 0.2, 0.8), (1.0, 0, 0), (0, 1.4, 0))
VIEW = look_at((1.6, -2.2, 1.6), (-0.8, 1.5, 0.9), (96, 64), 1.3)


@pytest.fixture
def room():
    return make_scene([*CLOSED, *WALL, TABLE], world=1.0)


def test_the_world_is_sampled_through_a_window(device, room, monkeypatch):
    """With a third of the error at least, and a ninth of its square times the rays; and the mean is the same."""
    reference = draw(device, room, VIEW, with_quality(replace(SETTINGS, shortcuts=False), samples=1024)).color[..., :3]
    errors, rays = {}, {}
    for gain in (np.inf, portals.MIN_GAIN):
        monkeypatch.setattr(portals, "MIN_GAIN", gain)
        drawn = draw(device, room, VIEW, with_quality(SETTINGS, samples=32))
        picture = drawn.color[..., :3]
        errors[gain] = np.sqrt(np.mean((picture - reference) ** 2)) / reference.mean()
        rays[gain] = sum(pixels(counts)[:64, :96, 1].sum() for counts in drawn.renderer.graph[RAY_COUNTS].values())
        found = drawn.renderer.graph[PORTALS]
        assert (found is None) == (gain == np.inf)
    assert picture.mean() == pytest.approx(reference.mean(), rel=0.01)
    assert errors[portals.MIN_GAIN] < errors[np.inf] / 3.0
    cost = {gain: rays[gain] * errors[gain] ** 2 for gain in rays}
    assert cost[portals.MIN_GAIN] < cost[np.inf] / 9.0


@pytest.mark.parametrize("roughness", [0.3, 0.7])
def test_faint_gloss_adds_little_noise(device, room, roughness):
    """Most rays still go through the window, not to where the lobe reflects walls."""
    builder = Builder()
    normal, white = builder.call("geometry_normal"), constant((1.0, 1.0, 1.0))
    gloss = builder.call("closure_glossy", constant((0.04,) * 3), white, constant(roughness), normal, parameter=0)
    graph, constants = builder.finish([builder.call("closure_diffuse", constant((0.56,) * 3), normal), gloss])
    materials = replace(
        room.materials, graph=np.zeros(1, np.int32), first_constant=np.zeros(1, np.int32), constants=constants
    )
    errors = []
    for scene in (room, replace(room, materials=materials, graphs=(graph,))):
        reference = draw(device, scene, VIEW, with_quality(SETTINGS, samples=1024)).color[..., :3]
        picture = draw(device, scene, VIEW, with_quality(SETTINGS, samples=16)).color[..., :3]
        errors.append(np.sqrt(np.mean((picture - reference) ** 2)) / reference.mean())
    assert errors[1] < 1.3 * errors[0]


def test_the_first_sample_is_near_the_limit(device, room):
    """Probe rays go through the window, too: nine in ten would else find it dark."""
    reference = draw(device, room, VIEW, with_quality(SETTINGS, samples=256)).color[..., :3]
    first = draw(device, room, VIEW, SETTINGS).color[..., :3]
    blocks = [each.reshape(8, 8, 12, 8, 3).mean((1, 3)) for each in (first, reference)]
    assert np.median(np.abs(blocks[0] - blocks[1])) < 0.1 * np.median(blocks[1])


@pytest.mark.parametrize(
    "meshes", [(CLOSED[0], TABLE), CLOSED[:1], (*CLOSED, quad((-2, -2.5, 0), (0, 5, 0), (0, 0, 2.6)))]
)
def test_nothing_is_sampled_through_portals_outdoors_or_in_a_closed_room(device, meshes):
    drawn = draw(device, make_scene(list(meshes), world=1.0), VIEW, SETTINGS)
    assert drawn.renderer.graph[PORTALS] is None


def test_no_ray_looks_for_openings_outdoors_or_without_a_world(device, room, monkeypatch):
    def fail(*_arguments):
        raise AssertionError("rays are traced")

    monkeypatch.setattr(find_portals.FindPortals, "trace", fail)
    draw(device, make_scene([CLOSED[0], TABLE], world=1.0), VIEW, SETTINGS)
    draw(device, make_scene([*CLOSED, *WALL], light(position=(0, 0, 2.0)), world=0.0), VIEW, SETTINGS)
    draw(device, room, VIEW, replace(SETTINGS, shadow=Shadow(world=False)))
    with pytest.raises(AssertionError, match="rays are traced"):
        draw(device, room, VIEW, SETTINGS)


def test_portals_follow_the_room(device, room):
    """Lights and portals are both in the scene's records: a picture after a change is that of a new renderer."""
    lit = replace(room, lights=light(position=(0.5, 0, 2.5)))
    settings = with_quality(SETTINGS, samples=2)
    drawn = draw(device, room, VIEW, settings)
    for scene in (lit, make_scene([CLOSED[0], TABLE], world=1.0), room):
        again = draw(device, scene, VIEW, settings, drawn.renderer).color
        assert np.array_equal(again, draw(device, scene, VIEW, settings).color)
