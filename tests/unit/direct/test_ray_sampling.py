# SPDX-License-Identifier: GPL-3.0-or-later
"""A pixel's rays sample a light evenly, also jointly with subpixel offsets, neighbouring pixels and other lights."""

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

#: Side of the image, and radius of the filter. px
SIZE, FILTER_RADIUS = 16, 1.5


def pixel_indices() -> np.ndarray:
    """(SIZE,SIZE): each pixel's index in the sequence, by interleaved bits of column and row, see pixel_sequence."""
    bits = (np.arange(SIZE)[:, None] >> np.arange(4)) & 1
    return (bits @ 4 ** np.arange(4))[None] + 2 * (bits @ 4 ** np.arange(4))[:, None]


def partly_occluded_lights(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Square lights behind straight edges: the edges' normals (2,count) and offsets, the lights' visibility."""
    random = np.random.default_rng(8)
    angles = 2.0 * np.pi * random.random(count)
    normals = np.stack([np.cos(angles), np.sin(angles)])
    offsets = (random.random((count, 2)).T * normals).sum(0)
    points = (np.indices((200, 200)).reshape(2, -1).T + 0.5) / 200
    return normals, offsets, (points @ normals > offsets).mean(0)


def errors(ray_increments, pixel_increments, samples: int) -> tuple[float, float]:
    """RMS errors: of filtered pixels, by all samples but the first; of windows of 5×5 pixels, by three rays a pixel."""
    normals, offsets, visibility = partly_occluded_lights(60)
    start = pixel_indices()[..., None] * np.array(pixel_increments)
    subpixel_offsets = np.concatenate([pixel_grid(index, 16).subpixel_offsets for index in range(samples // 16)])
    inner = SIZE - 4
    filtered, weights, window = 0.0, 0.0, 0.0
    for sample, subpixel_offset in enumerate(subpixel_offsets[1:], 1):
        error = (np.mod(start + sample * np.array(ray_increments), 1.0) @ normals > offsets) - visibility
        for y, x in np.ndindex(5, 5):
            weight = blackman_harris((subpixel_offset + (x - 2, y - 2)) / FILTER_RADIUS).prod()
            neighbour = error[y : y + inner, x : x + inner]
            filtered, weights = filtered + weight * neighbour, weights + weight
            window = window + neighbour / 75.0 * (sample < 4)
    return float(np.sqrt(((filtered / weights) ** 2).mean())), float(np.sqrt((window**2).mean()))


def test_rays_are_evenly_distributed_jointly_with_subpixel_offsets():
    """The additive sequence of two dimensions (Roberts 2018), which is even only by itself, has 1.5 times the error."""
    ray_increments, pixel_increments = (Dimension.LIGHT_POINT.value[index] for index in ("ray", "pixel"))
    increments = Dimension.PIXEL.value["sample"]
    for samples in (16, 32, 64):
        ours, theirs = errors(ray_increments, pixel_increments, samples), errors(increments, increments[::-1], samples)
        assert ours[0] < {16: 0.9, 32: 0.75, 64: 0.75}[samples] * theirs[0]
        assert ours[1] < 1.05 * theirs[1]


def lights_behind_an_edge(count: int, radiance: float) -> Scene:
    """A floor under `count` lights of `radiance` in one place, half occluded at its centre by a plate.

    There is also a light of radiance 1 without shadows. The camera does not see the plate.
    """
    lights = [light(casts_shadow=False), *[light(radiance=radiance)] * count]
    floor, plate = quad((-2, -2, 0), (4, 0, 0), (0, 4, 0)), quad((-3, -3, 1), (3, 0, 0), (0, 6, 0))
    scene = make_scene([floor, plate], reduce(join_lights, lights))
    return replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))


@pytest.fixture
def visibility(device, monkeypatch):
    """visibility(view, count, radiance): (H,W) mean visibility of these lights, by one ray of each pixel to each."""
    for name in ("MIN_RAY_PROBABILITY", "MIN_FAINT_RAY_PROBABILITY"):
        monkeypatch.setattr(trace_shadows, name, 1.0)  # all pixels trace one ray
    monkeypatch.setattr(select_faint_lights, "MIN_LIGHT_PROBABILITY", 1.0)

    def irradiance(view: View, count: int, radiance: float) -> np.ndarray:
        drawn = draw(device, lights_behind_an_edge(count, radiance), view, with_quality(SMALL_SETTINGS, samples=2))
        influences = [drawn.renderer.graph[LIGHT_INFLUENCE][light] for light in range(1, count + 1)]
        assert all(influence.is_faint.any() == (radiance < 0.01) for influence in influences)
        return (drawn.target("direct_prediction") + drawn.target("direct_residual"))[..., 0]

    return lambda view, count, radiance: (
        (irradiance(view, count, radiance) / irradiance(view, 0, 0.0) - 1.0) / (count * radiance)
    )


def test_no_two_rows_of_pixels_sample_the_same_points(visibility):
    """However far apart the rows are."""
    unoccluded = visibility(view_from_above(0.1, (8, 200)), 1, 1.0) > 0.5
    assert 0.3 < unoccluded.mean() < 0.7
    agreement = [(unoccluded[distance:] == unoccluded[:-distance]).mean() for distance in range(1, 150)]
    assert max(agreement) < 0.95


@pytest.mark.parametrize("radiance", [1.0, 0.002], ids=["bright", "faint"])
def test_lights_in_one_place_are_sampled_at_different_points(visibility, radiance):
    """One ray to each of a dozen lights is as accurate as a dozen rays to one light: their errors average out."""
    errors = {}
    for count in 1, 12:
        estimates = visibility(view_from_above(0.6, (32, 32)), count, radiance)
        errors[count] = np.sqrt(((estimates - estimates.mean(0)) ** 2).mean())
    assert errors[12] < 0.3 * errors[1]
