# SPDX-License-Identifier: GPL-3.0-or-later
"""Virtual lights: each light has the requested count, on its surface, at other positions in each sample."""

import numpy as np
import pytest

from ism_addon.gpu.passes.shadow_maps.virtual_lights import virtual_light_tables
from ism_addon.scene import LightShape
from tests.scenes.small import subdivided_box
from tests.support.emission import textured
from tests.support.small_scenes import (
    SMALL_SHADOW_MAPS,
    draw,
    join_lights,
    light,
    look_at,
    make_scene,
    quad,
    with_quality,
)

ORIGIN = np.zeros(3)


def three_lights():
    """Three lights, a disk among them."""
    large = light(LightShape.ELLIPSE, (1.0, 0.0, 3.0), (2.0, 0.0, 0.0), (0.0, -2.0, 0.0), radiance=1.0)
    bright = light(
        position=(0.0, 5.0, 1.0), axis_u=(0.0, 0.0, 1.0), axis_v=(0.5, 0.0, 0.0), radiance=18.0 * np.pi / 2.0
    )
    return join_lights(join_lights(light(radiance=np.pi / 2.0), large), bright)


def test_the_range_of_a_light_holds_its_virtual_lights():
    lights = three_lights()
    counts = {0: 7, 2: 93}
    table, _, points = virtual_light_tables(lights, counts, 3, ORIGIN)
    assert dict(zip(table["light"], table["count"], strict=True)) == counts
    assert len(points) == 100
    for row, index in enumerate(counts):
        rows = slice(int(table["first"][row]), int(table["first"][row] + table["count"][row]))
        assert (points["light"][rows] == index).all()
        offsets = points["position"][rows] - lights.position[index]
        axes = np.stack([lights.axis_u[index], lights.axis_v[index]])
        across = offsets @ axes.T / (axes**2).sum(1)
        assert np.abs(offsets @ lights.normal[index]).max() < 1e-6
        assert np.abs(across).max() <= 0.5 + 1e-6
        assert points["map_from_anchor"][rows, 2] == pytest.approx(np.tile(lights.normal[index], (len(offsets), 1)))


def test_each_map_has_a_rotation_of_its_own():
    _, _, points = virtual_light_tables(three_lights(), {0: 10, 1: 20, 2: 30}, 0, ORIGIN)
    rotations = points["map_from_anchor"].astype(float)
    assert rotations @ rotations.swapaxes(1, 2) == pytest.approx(np.tile(np.eye(3), (60, 1, 1)), abs=1e-6)
    assert (np.linalg.det(rotations) > 0.0).all()
    assert len(np.unique(np.round(rotations[:, 0], 4), axis=0)) == 60


def test_each_sample_has_other_points_and_together_they_cover_the_light():
    lights = light()
    samples = [virtual_light_tables(lights, {0: 16}, sample, ORIGIN)[2]["position"] for sample in range(64)]
    assert len(np.unique(np.round(np.concatenate(samples), 6), axis=0)) > 1000
    counts = np.histogram2d(*np.concatenate(samples)[:, :2].T, 8, ((-0.5, 0.5), (-0.5, 0.5)))[0]
    assert counts.min() > 0.5 * 16
    assert counts.max() < 1.5 * 16


def test_two_equal_lights_have_different_points():
    _, _, points = virtual_light_tables(join_lights(light(), light()), {0: 16, 1: 16}, 0, ORIGIN)
    assert not np.allclose(points["position"][points["light"] == 0], points["position"][points["light"] == 1])


def test_virtual_lights_are_exact_far_from_the_worlds_origin():
    far = np.array([1e7, 0.0, -1e7])
    here = virtual_light_tables(light(), {0: 10}, 0, ORIGIN)
    there = virtual_light_tables(light(position=far + (0.0, 0.0, 2.0)), {0: 10}, 0, far)
    assert there[2]["position"] == pytest.approx(here[2]["position"], abs=1e-6)
    assert there[1]["offset"] == pytest.approx(here[1]["offset"], abs=1e-6)


def test_more_lights_than_virtual_lights(device):
    lights = light()
    for k in range(9):
        lights = join_lights(lights, light(position=(0.3 * k, 0.0, 2.0)))
    drawn = draw(
        device,
        make_scene([quad((-5, -5, 0), (10, 0, 0), (0, 10, 0))], lights),
        look_at((3, -3, 2)),
        with_quality(SMALL_SHADOW_MAPS, virtual_lights=4),
    )
    assert drawn.profile.counts["virtual_lights"] == 10
    assert drawn.color[..., :3].max() > 0.2


def test_bright_triangles_of_a_mesh_have_more_virtual_lights():
    box = subdivided_box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0), 1)
    middles = box.positions[box.triangles].mean(1)
    lights = textured(box, np.where(middles[:, 2:] > 0.99, 9.0, 1.0) * np.ones(3))
    _, _, points = virtual_light_tables(lights, {0: 700}, 0, ORIGIN)
    assert np.isclose((points["position"][:, 2] > 0.99).mean(), 9.0 / 14.0, atol=0.01)
