# SPDX-License-Identifier: GPL-3.0-or-later
"""A world that is turned keeps its map and its tables, and looks as one whose map was turned."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.environment.map_tables import MapTables
from ism_addon.gpu.environment.rotation import without_rotation
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import World
from ism_addon.settings import Shadow
from ism_addon.shading.builder import Builder, constant
from ism_addon.shading.vectors import euler_matrix
from tests.scenes.small import sphere
from tests.support.small_scenes import SMALL_SETTINGS, draw, look_at, make_scene, quad, with_quality

TRACED = replace(with_quality(SMALL_SETTINGS, samples=16), shadow=Shadow(world=True))
ANGLES = (0.4, -0.3, 1.1)


def world(
    angles=ANGLES, mapping="mapping_point", location=(0.0, 0.0, 0.0), scale=(1.0, 1.0, 1.0), before=None, twice=False
):
    """A world whose radiance grows along axes of the map; `before`: angles of a rotation that all else is turned by."""
    builder = Builder(simplify=False)
    direction = builder.call("world_direction")
    turned = builder.call(mapping, direction, *(constant(each) for each in (location, angles, scale)))
    color = builder.call("vector_add", turned, constant((1.1, 1.1, 1.1)))
    if twice:
        color = builder.call("vector_add", color, direction)
    graph, constants = builder.finish([builder.call("closure_emission", color)])
    return graph, World.of(
        radiance=np.ones(3, np.float32),
        background=np.ones(3, np.float32),
        graph=[0, 0],
        first_constant=[0, 0],
        constants=constants,
    )


def lit_by(graph, of):
    floor, ball = quad((-9, -9, 0), (18, 0, 0), (0, 18, 0)), sphere((0.0, 0.0, 0.6), 0.5, 32, 16)
    return replace(make_scene([floor, ball]), world=of, graphs=(graph,))


VIEW = look_at((0.0, -3.0, 2.0), (0.0, 0.0, 0.3), (48, 32))


@pytest.mark.parametrize("mapping", ["mapping_point", "mapping_vector", "mapping_normal", "mapping_texture"])
def test_the_rotation_is_taken_out_of_the_constants(mapping):
    graph, of = world(mapping=mapping)
    rotation, rest = without_rotation(graph, of.constants)
    expected = euler_matrix(np.array(ANGLES))
    assert rotation == pytest.approx(expected.T if mapping == "mapping_texture" else expected, abs=1e-6)
    again, same = without_rotation(graph, rest)
    assert np.array_equal(again, np.eye(3)) and np.array_equal(same, rest)
    assert not np.array_equal(rest, of.constants)


@pytest.mark.parametrize("changes", [{"location": (0.1, 0, 0)}, {"scale": (1, 2, 1)}, {"twice": True}], ids=str)
def test_what_is_not_only_turned_stays(changes):
    graph, of = world(**changes)
    rotation, rest = without_rotation(graph, of.constants)
    assert np.array_equal(rotation, np.eye(3)) and rest is of.constants


def test_turning_makes_no_map_and_gives_the_same_picture(device, monkeypatch):
    graph, of = world()
    scene = lit_by(graph, of)
    renderer = Renderer(device)
    before = draw(device, scene, VIEW, TRACED, renderer).color
    turned = replace(scene, world=world(angles=(0.0, 0.9, -0.2))[1])
    with monkeypatch.context() as patch:
        patch.setattr(MapTables, "of", None)  # cannot be called
        again = draw(device, turned, VIEW, TRACED, renderer).color
    assert np.array_equal(again, draw(device, turned, VIEW, TRACED).color)
    assert not np.array_equal(again, before)


def test_a_turned_map_lights_as_one_that_was_made_turned(device):
    """The map of a graph that also reads the direction otherwise is made turned."""
    graph, of = world()
    plain = draw(device, lit_by(graph, of), VIEW, with_samples(256)).color
    other, whole = world(scale=(1.0, 1.0, 1.000001))
    assert np.array_equal(without_rotation(other, whole.constants)[0], np.eye(3))
    made_turned = draw(device, lit_by(other, whole), VIEW, with_samples(256)).color
    assert np.sqrt(((plain - made_turned)[..., :3] ** 2).mean()) < 0.005 * plain.mean()


def with_samples(samples):
    return with_quality(TRACED, samples=samples)
