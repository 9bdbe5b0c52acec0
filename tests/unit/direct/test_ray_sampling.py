# SPDX-License-Identifier: GPL-3.0-or-later
"""A pixel's rays go to places on a light that are even together with their places in the pixel, its neighbours', and
those on other lights."""

from dataclasses import replace
from functools import reduce

import numpy as np
import pytest

from ism_addon.gpu.passes.direct import select_faint_lights, trace_shadows
from ism_addon.resources import LIGHT_INFLUENCE
from ism_addon.sampling.dimensions import Dimension
from ism_addon.sampling.pixel_grid import pixel_grid
from ism_addon.scene import Scene, View
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    draw,
    join_lights,
    light,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)
from tests.unit.film.test_accumulate import blackman_harris

#: Pixels along the square that is looked at, and how wide the filter reaches.
SIZE, REACH = 16, 1.5


def order_of_pixels() -> np.ndarray:
    """(SIZE,SIZE) each pixel's member of the sequence: the bits of its column and row in turn, see pixel_sequence."""
    bits = (np.arange(SIZE)[:, None] >> np.arange(4)) & 1
    return (bits @ 4 ** np.arange(4))[None] + 2 * (bits @ 4 ** np.arange(4))[:, None]


def half_seen_lights(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Square lights behind a straight edge: its normals (count,2), offsets, and what part of each light is seen."""
    random = np.random.default_rng(8)
    angles = 2.0 * np.pi * random.random(count)
    normals = np.stack([np.cos(angles), np.sin(angles)])
    offsets = (random.random((count, 2)).T * normals).sum(0)
    everywhere = (np.indices((200, 200)).reshape(2, -1).T + 0.5) / 200
    return normals, offsets, (everywhere @ normals > offsets).mean(0)


def errors(ray_steps, pixel_steps, samples: int) -> tuple[float, float]:
    """Of filtered pixels, of all rays but the first sample's; and of windows of 5×5 pixels, of the first three rays."""
    normals, offsets, seen = half_seen_lights(60)
    start = order_of_pixels()[..., None] * np.array(pixel_steps)
    places = np.concatenate([pixel_grid(number, 16).subpixel_offsets for number in range(samples // 16)])
    inner = SIZE - 4
    filtered, weights, window = 0.0, 0.0, 0.0
    for number, place in enumerate(places[1:], 1):
        wrong = (np.mod(start + number * np.array(ray_steps), 1.0) @ normals > offsets) - seen
        for y, x in np.ndindex(5, 5):
            weight = blackman_harris((place + (x - 2, y - 2)) / REACH).prod()
            near = wrong[y : y + inner, x : x + inner]
            filtered, weights = filtered + weight * near, weights + weight
            window = window + near / 75.0 * (number < 4)
    return float(np.sqrt(((filtered / weights) ** 2).mean())), float(np.sqrt((window**2).mean()))


def test_rays_are_even_together_with_the_places_in_the_pixel():
    """The additive sequence of two dimensions (Roberts 2018), which is even by itself, leaves half as much again."""
    ray_steps, pixel_steps = (Dimension.LIGHT_POINT.value[index] for index in ("ray", "pixel"))
    steps = Dimension.PIXEL.value["sample"]
    for samples in (16, 32, 64):
        ours, theirs = errors(ray_steps, pixel_steps, samples), errors(steps, steps[::-1], samples)
        assert ours[0] < {16: 0.9, 32: 0.75, 64: 0.75}[samples] * theirs[0]
        assert ours[1] < 1.05 * theirs[1]


def before_an_edge(count: int, part: float) -> Scene:
    """A floor in whose middle a half is hidden of so many lights in one place, each of `part` of the light.

    All else comes from a light that nothing hides. What hides the others is not seen.
    """
    lights = [light(casts_shadow=False), *[light(radiance=part)] * count]
    floor, plate = quad((-2, -2, 0), (4, 0, 0), (0, 4, 0)), quad((-3, -3, 1), (3, 0, 0), (0, 6, 0))
    scene = make_scene([floor, plate], reduce(join_lights, lights))
    return replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))


@pytest.fixture
def seen(device, monkeypatch):
    """seen(view, count, part): (H,W) how much of those lights the first ray of each pixel to each of them finds."""
    for name in ("MIN_RAY_PROBABILITY", "MIN_FAINT_RAY_PROBABILITY"):
        monkeypatch.setattr(trace_shadows, name, 1.0)  # all pixels have one
    monkeypatch.setattr(select_faint_lights, "MIN_LIGHT_PROBABILITY", 1.0)

    def irradiance(view: View, count: int, part: float) -> np.ndarray:
        drawn = draw(device, before_an_edge(count, part), view, with_quality(SMALL_SETTINGS, samples=2))
        influences = [drawn.renderer.graph[LIGHT_INFLUENCE][light] for light in range(1, count + 1)]
        assert all(influence.is_faint.any() == (part < 0.01) for influence in influences)
        return (drawn.target("direct_prediction") + drawn.target("direct_residual"))[..., 0]

    return lambda view, count, part: (irradiance(view, count, part) / irradiance(view, 0, 0.0) - 1.0) / (count * part)


def test_no_two_rows_of_pixels_have_the_same_places(seen):
    """As far apart as they may be."""
    arrived = seen(view_from_above(0.1, (8, 200)), 1, 1.0) > 0.5
    assert 0.3 < arrived.mean() < 0.7
    alike = [(arrived[apart:] == arrived[:-apart]).mean() for apart in range(1, 150)]
    assert max(alike) < 0.95


@pytest.mark.parametrize("part", [1.0, 0.002], ids=["bright", "faint"])
def test_lights_in_one_place_have_places_of_their_own(seen, part):
    """One ray to each of a dozen lights says as much as a dozen to one: their errors do not add up."""
    errors = {}
    for count in 1, 12:
        found = seen(view_from_above(0.6, (32, 32)), count, part)
        errors[count] = np.sqrt(((found - found.mean(0)) ** 2).mean())
    assert errors[12] < 0.3 * errors[1]
