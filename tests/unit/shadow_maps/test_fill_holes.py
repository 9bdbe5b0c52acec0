# SPDX-License-Identifier: GPL-3.0-or-later
"""Hole filling against numpy, and its requirements: holes are closed, and silhouettes do not grow."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.shadow_maps.atlas import Batch, batches
from ism_addon.gpu.passes.shadow_maps.fill_holes import LEVELS, FillHoles
from ism_addon.resources import ATLAS_BATCH, NO_OCCLUDER, SHADOW_MAP_SPLATS, SHADOW_MAPS
from tests.support.reference_maps import pull_push
from tests.support.small_scenes import (
    SMALL_SHADOW_MAPS,
    draw,
    first_frame,
    light,
    look_at,
    make_scene,
    quad,
    random_triangles,
    with_quality,
    with_shadow,
    write_texels,
)

SIDE = 64


def filled(device, depths: np.ndarray, threshold: float = 0.02) -> np.ndarray:
    """(S,side,side) maps after FillHoles, all in one atlas of two columns."""
    count, side = len(depths), depths.shape[1]
    batch = Batch(0, count, side, 2)
    settings = replace(SMALL_SHADOW_MAPS, shadow=replace(SMALL_SHADOW_MAPS.shadow, fill_threshold=threshold))
    renderer, frame = first_frame(device, make_scene([], light()), settings)
    frame[ATLAS_BATCH] = batch
    atlas = np.full(batch.size[::-1], NO_OCCLUDER, np.float32)
    corners = [batch.corner(index) for index in range(count)]
    for depth, (x, y) in zip(depths, corners, strict=True):
        atlas[y : y + side, x : x + side] = depth
    frame.graph.targets.allocate(SHADOW_MAP_SPLATS, batch.size)
    write_texels(frame[SHADOW_MAP_SPLATS], atlas)
    renderer.graph.instance(FillHoles).execute(frame)
    pixels = frame.graph.targets.read(SHADOW_MAPS)[..., 0]
    return np.array([pixels[y : y + side, x : x + side] for x, y in corners])


def plate(radius: float, depth: float = 2.0, side: int = SIDE) -> np.ndarray:
    """A map of a round plate before an empty background."""
    y, x = np.mgrid[:side, :side] - side / 2 + 0.5
    return np.where(x**2 + y**2 < radius**2, depth, NO_OCCLUDER)


def with_holes(depth: np.ndarray, fraction: float, seed: int = 0) -> np.ndarray:
    """The map without a random fraction of its texels."""
    return np.where(np.random.default_rng(seed).random(depth.shape) < fraction, NO_OCCLUDER, depth)


@pytest.mark.parametrize("threshold", [0.0, 0.02, 0.3, 1.0])
def test_random_maps_against_numpy(device, threshold):
    random = np.random.default_rng(2)
    surfaces = random.choice([1.0, 1.01, 1.2, 3.0], (5, SIDE // 8, SIDE // 8)).repeat(8, 1).repeat(8, 2)
    noise = 1.0 + 0.004 * random.standard_normal((5, SIDE, SIDE))
    fractions = (0.0, 0.2, 0.5, 0.8, 0.97)
    maps = np.array([with_holes(surfaces[k] * noise[k], fraction, k) for k, fraction in enumerate(fractions)])
    maps = maps.astype(np.float32).astype(float)
    ours = filled(device, maps, threshold)
    truth = np.array([pull_push(m, NO_OCCLUDER, threshold, LEVELS) for m in maps])
    assert (~np.isclose(ours, truth, rtol=1e-5)).mean() < 2e-3  # depths at the threshold itself


def test_the_maps_of_a_scene_against_numpy(device):
    settings = with_quality(with_shadow(), virtual_lights=5, map_size=64, map_points=1500)
    drawn = draw(device, make_scene([random_triangles()], light()), look_at((3.0, -3.0, 2.0)), settings)
    (batch,) = batches(5, 64, device.texture_size)
    splats, maps = drawn.target("shadow_map_splats")[..., 0], drawn.target("shadow_maps")[..., 0]
    for index in range(5):
        x, y = batch.corner(index)
        area = np.s_[y : y + 64, x : x + 64]
        truth = pull_push(splats[area], NO_OCCLUDER, settings.shadow.fill_threshold, LEVELS)
        assert (~np.isclose(maps[area], truth, rtol=1e-5)).mean() < 2e-3


@pytest.mark.parametrize(("fraction", "closed"), [(0.05, 0.999), (0.2, 0.98), (0.35, 0.85)])
def test_holes_are_filled_with_the_surface_around_them(device, fraction, closed):
    """Random texels are missing. Clusters of them that are as large as the texels between them stay open."""
    (ours,) = filled(device, with_holes(plate(26.0), fraction)[None])
    inner = plate(22.0) < NO_OCCLUDER
    assert (ours[inner] < NO_OCCLUDER).mean() > closed
    assert ours[inner & (ours < NO_OCCLUDER)] == pytest.approx(2.0)


def test_a_silhouette_does_not_grow(device):
    for radius in (1.0, 2.5, 6.0, 11.3, 26.0):
        depths = plate(radius)
        (ours,) = filled(device, depths[None])
        grown = (ours < NO_OCCLUDER) & (depths >= NO_OCCLUDER)
        circumference = 2.0 * np.pi * radius
        assert grown.sum() <= 0.25 * circumference, radius
        assert not grown[plate(radius + 1.5) >= NO_OCCLUDER].any(), radius
        assert np.array_equal(ours[depths < NO_OCCLUDER], depths[depths < NO_OCCLUDER])


def test_holes_before_a_far_surface_are_filled(device):
    """A near plate with holes before a far wall: the wall is visible through the holes, and after filling hardly is."""
    near = with_holes(plate(24.0, 1.0), 0.15)
    (ours,) = filled(device, np.where(near < NO_OCCLUDER, near, 5.0)[None])
    inner = plate(20.0) < NO_OCCLUDER
    assert (ours[inner] == 5.0).mean() < 0.1 * (near[inner] >= NO_OCCLUDER).mean()
    assert (ours[plate(26.5) >= NO_OCCLUDER] == 5.0).all()


def test_depths_that_differ_by_more_than_the_threshold_are_not_averaged(device):
    """Two surfaces side by side: each texel between them has the depth of one of them."""
    maps = np.where(np.arange(SIDE) < 31, 1.0, 2.0) * np.ones((SIDE, 1))
    (ours,) = filled(device, with_holes(maps, 0.3)[None])
    present = ours[ours < NO_OCCLUDER]
    assert (np.isclose(present, 1.0) | np.isclose(present, 2.0)).all()


def test_maps_do_not_leak_into_their_neighbours(device):
    full, empty = np.full((SIDE, SIDE), 3.0), np.full((SIDE, SIDE), NO_OCCLUDER)
    ours = filled(device, np.array([full, empty, empty, full]))
    assert (ours[[1, 2]] >= NO_OCCLUDER).all()
    assert (ours[[0, 3]] == 3.0).all()
    depths = np.array([3.0, 3.02, 3.04, 2.98])  # so similar that the threshold takes them for one surface
    ours = filled(device, np.array([with_holes(np.full((SIDE, SIDE), depth), 0.3) for depth in depths]))
    assert np.isclose(np.where(ours < NO_OCCLUDER, ours, depths[:, None, None]), depths[:, None, None], rtol=1e-6).all()


def test_fill_holes_is_skipped_when_it_is_disabled(device):
    scene = make_scene([quad((-1, -1, 0), (2, 0, 0), (0, 2, 0))], light())
    drawn = draw(device, scene, look_at((3.0, -3.0, 2.0)), with_shadow(fill_holes=False))
    assert drawn.profile.rows["FillHoles"].drawn == 0
    assert drawn.profile.rows["GatherLight"].drawn == 1
