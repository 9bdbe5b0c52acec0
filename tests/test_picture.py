# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole pictures: three small scenes against every ray and every triangle; scenes in which something is missing."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.settings import SSAO, Quality, Settings, Shadow

from . import reference
from .scenes.small import SMALL, mesh
from .studio import SMALL_SETTINGS, both, draw, light, look, placed, quad, rubble, stage, with_quality

#: For each small scene, the points across its lights in the reference, and the bound on the root of the mean squared
#: error over the mean. Measured: 0.020, 0.023 and 0.069, of which up to 0.03 is the pillars' reference itself.
BOUNDS = {"box over plane": (8, 0.03), "sphere in corner": (7, 0.035), "pillar field": (12, 0.10)}

SETTINGS = Settings(
    ssao=SSAO(enabled=False), quality=Quality(samples=4, light_points=64, map_size=128, surface_points=16384)
)

#: Ways to break the method that must show: each takes every scene over its bound.
BROKEN = {
    "no bias": Shadow(bias=0.0),
    "no shadows": Shadow(enabled=False),
    "discs too small": Shadow(splat_size=0.4, fill_holes=False),
    "discs too large": Shadow(splat_size=6.0),
}


@pytest.fixture(scope="module")
def truths():
    """Of each small scene: scene, view, picture (N,3), bound."""
    found = {}
    for name, make in SMALL.items():
        scene, view = make(48, 32)
        side, bound = BOUNDS[name]
        found[name] = scene, view, reference.picture(scene, view, side)[0], bound
    return found


@pytest.mark.parametrize("name", SMALL)
def test_the_picture_is_the_references(device, truths, name):
    scene, view, truth, bound = truths[name]
    color = draw(device, scene, view, SETTINGS).color[..., :3].reshape(-1, 3)
    assert reference.nrmse(color, truth) < bound
    assert abs(color.mean() / truth.mean() - 1.0) < 0.02


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("broken", BROKEN)
def test_the_bound_notices_what_is_broken(device, truths, name, broken):
    scene, view, truth, bound = truths[name]
    settings = with_quality(replace(SETTINGS, shadow=BROKEN[broken]), samples=1)
    color = draw(device, scene, view, settings).color[..., :3].reshape(-1, 3)
    assert reference.nrmse(color, truth) > 1.3 * bound


@pytest.mark.parametrize("name", SMALL)
def test_unshadowed_pixels_are_exact(device, truths, name):
    """Where the reference says that nothing is in any light's way, light arrives whole: within 2 %."""
    scene, view, truth, _ = truths[name]
    open_scene = replace(scene, lights=replace(scene.lights, casts_shadow=np.zeros_like(scene.lights.casts_shadow)))
    side, _ = BOUNDS[name]
    open_truth, surface = reference.picture(open_scene, view, side)
    lit = surface.seen & (np.abs(open_truth - truth).max(1) < 1e-6)
    color = draw(device, scene, view, SETTINGS).color[..., :3].reshape(-1, 3)
    off = np.abs(color - truth).max(1)[lit] / truth.max(1)[lit]
    assert lit.sum() > 300
    assert np.quantile(off, 0.9) < 0.02


def test_without_shadows_the_reference_is_met_everywhere(device, truths):
    for name, (scene, view, _, _) in truths.items():
        open_scene = replace(scene, lights=replace(scene.lights, casts_shadow=np.zeros_like(scene.lights.casts_shadow)))
        truth, surface = reference.picture(open_scene, view, 16)
        color = draw(device, open_scene, view, SETTINGS).color[..., :3].reshape(-1, 3)
        off = np.abs(color - truth).max(1)[surface.seen]
        assert np.quantile(off / truth.max(1)[surface.seen], 0.98) < 0.02, name


@pytest.mark.parametrize("offset", [1e4, 1e6])
def test_far_from_the_worlds_origin_the_picture_is_the_same(device, offset):
    """Camera, lights and meshes moved together."""
    far = np.array([offset, -offset, offset])
    lamp = light(position=(0.3, 0.0, 2.0))
    here = draw(device, stage([rubble(), quad((-2, -2, -1), (4, 0, 0), (0, 4, 0))], lamp), look((3, -3, 2)))
    moved = replace(lamp, position=lamp.position + far)
    scene = stage([rubble(), quad((-2, -2, -1), (4, 0, 0), (0, 4, 0))], moved, matrices=[placed(offset=far)] * 2)
    there = draw(device, scene, look(far + (3, -3, 2), far))
    assert reference.nrmse(there.color, here.color) < 0.05


def test_no_meshes(device):
    drawn = draw(device, stage([], light(), world=0.2), look((3, -3, 2)))
    assert drawn.color == pytest.approx(np.broadcast_to([0.2, 0.2, 0.2, 1.0], (24, 32, 4)))


def test_no_lights(device):
    drawn = draw(device, stage([quad((-9, -9, 0), (18, 0, 0), (0, 18, 0))], world=0.5), look((3, -3, 6)))
    assert drawn.color[..., :3] == pytest.approx(0.3, abs=1e-3)
    assert drawn.profile.rows["Splat"].drawn == drawn.profile.rows["Gather"].drawn == 0


def test_neither_lights_nor_meshes_nor_a_world(device):
    assert not draw(device, stage([]), look((3, -3, 2))).color[..., :3].any()


def floor_and_plate():
    return [quad((-2, -2, 0), (4, 0, 0), (0, 4, 0)), quad((-0.5, -0.5, 1.0), (1, 0, 0), (0, 1, 0))]


def test_an_unshadowed_light_among_others(device):
    """Each light is as it would be alone, with its shadow or without."""
    one, other = light(position=(1.0, 0.0, 2.0), casts_shadow=False), light(position=(-1.0, 0.0, 2.0))
    settings = with_quality(SMALL_SETTINGS, light_points=32)
    together = draw(device, stage(floor_and_plate(), both(one, other)), look((3, -3, 3)), settings).color
    apart = [draw(device, stage(floor_and_plate(), lamp), look((3, -3, 3)), settings).color for lamp in (one, other)]
    assert reference.nrmse(together[..., :3], apart[0][..., :3] + apart[1][..., :3]) < 0.15
    bright = draw(
        device, stage(floor_and_plate(), replace(one, casts_shadow=np.array([True]))), look((3, -3, 3)), settings
    ).color
    assert (apart[0] - bright)[..., :3].max() > 0.01


def test_what_casts_no_shadow_is_seen_and_throws_none(device):
    scene = stage(floor_and_plate(), light())
    ghost = replace(scene, instances=replace(scene.instances, casts_shadow=np.array([True, False])))
    open_floor = stage(floor_and_plate()[:1], light())
    view = look((0.0, -6.0, 0.5), (0.0, 0.0, 0.5))
    ours, bare = draw(device, ghost, view), draw(device, open_floor, view)
    floor = (ours.target("triangle")[..., 0] <= 2) & (ours.target("triangle")[..., 0] > 0)
    assert np.abs(ours.color - bare.color)[floor].max() < 0.01
    assert np.abs(ours.color - draw(device, scene, view).color)[floor].max() > 0.012


def test_what_is_unseen_may_throw_a_shadow(device):
    scene = stage(floor_and_plate(), light())
    hidden = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
    drawn = draw(device, hidden, look((0.0, -3.0, 4.0)))
    assert set(np.unique(drawn.target("triangle")[..., 0])) <= {0, 1, 2}
    bare = draw(device, stage(floor_and_plate()[:1], light()), look((0.0, -3.0, 4.0)))
    assert (bare.color - drawn.color).max() > 0.03


def points_only():
    """A mesh whose triangles have no area."""
    up = np.broadcast_to(np.array([0.0, 0.0, 1.0]), (20, 3, 3))
    return mesh(np.random.default_rng(0).normal(size=(20, 3)), np.arange(20)[:, None].repeat(3, 1), up)


DEGENERATE = {
    "a mesh of points": lambda: stage([points_only()], light(), world=0.1),
    "a flat instance": lambda: stage([rubble(20)], light(), matrices=[placed(np.diag([1.0, 1.0, 0.0]))], world=0.1),
    "a light in the floor": lambda: stage(floor_and_plate(), light(position=(0.0, 0.0, 0.0)), world=0.1),
    "a light of no size": lambda: stage(floor_and_plate(), light(axis_u=(1e-9, 0, 0), axis_v=(0, -1e-9, 0)), world=0.1),
    "a light of no power": lambda: stage(floor_and_plate(), light(radiance=0.0), world=0.1),
    "a huge light": lambda: stage(floor_and_plate(), light(axis_u=(1e5, 0, 0), axis_v=(0, -1e5, 0)), world=0.1),
    "a very bright light": lambda: stage(floor_and_plate(), light(radiance=1e30), world=0.1),
    "a narrow spread": lambda: stage(floor_and_plate(), light(spread=0.0), world=0.1),
    "a tiny scene": lambda: stage([rubble(50)], light(), matrices=[placed(1e-6 * np.eye(3))], world=0.1),
    "a vast scene": lambda: stage([rubble(50)], light(), matrices=[placed(1e7 * np.eye(3))], world=0.1),
}


@pytest.mark.parametrize("name", DEGENERATE)
def test_no_pixel_is_nan_or_negative(device, name):
    settings = replace(SMALL_SETTINGS, ssao=SSAO(), quality=replace(SMALL_SETTINGS.quality, samples=2))
    color = draw(device, DEGENERATE[name](), look((0.0, -4.0, 3.0)), settings).color
    assert np.isfinite(color).all()
    assert color.min() >= 0.0


@pytest.mark.parametrize(
    "quality", [{"light_points": 1}, {"surface_points": 1}, {"map_size": 8}, {"light_points": 3, "map_size": 1000}]
)
def test_the_least_quality_still_gives_a_picture(device, quality):
    scene, view = SMALL["sphere in corner"](24, 16)
    color = draw(device, scene, view, with_quality(SMALL_SETTINGS, **quality)).color
    assert np.isfinite(color).all()
    assert color[..., :3].mean() > 0.05


@pytest.mark.parametrize("size", [(1, 1), (1, 40), (37, 1)])
def test_pictures_of_few_pixels(device, size):
    scene, view = SMALL["box over plane"](*size)
    settings = replace(SMALL_SETTINGS, ssao=SSAO())
    color = draw(device, scene, view, settings).color
    assert color.shape == (size[1], size[0], 4)
    assert np.isfinite(color).all()
