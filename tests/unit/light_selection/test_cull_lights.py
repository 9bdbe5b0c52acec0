# SPDX-License-Identifier: GPL-3.0-or-later
"""Light culling: bounds are never too low, culled lights do not change the picture, and missed light is found later."""

from dataclasses import replace
from functools import reduce

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ism_addon.gpu.culling import culling_state
from ism_addon.gpu.culling.culling_state import CullingState, light_influences
from ism_addon.gpu.culling.hidden_lights import COARSE_SIDE, HiddenLights
from ism_addon.gpu.culling.surface_bounds import SurfaceBounds
from ism_addon.gpu.lights.area import AreaLightBounds
from ism_addon.gpu.passes.light_selection import cull_lights
from ism_addon.resources import HIDDEN_LIGHTS, LIGHT_INFLUENCE, TILE_SIZE, TILE_VISIBILITY
from ism_addon.scene import Lights, LightShape
from ism_addon.settings import Shadow
from tests.scenes.rooms import IDLE, rooms
from tests.scenes.small import basis, box_over_plane, subdivided_box
from tests.support import reference
from tests.support.light_grids import irradiance
from tests.support.small_scenes import (
    AREA_SHAPES,
    SMALL_SETTINGS,
    draw,
    join_lights,
    light,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)

SIZE = 160, 96
#: Relative difference of pictures that are equal but for rounding.
ROUNDING = 1e-6


def bounds_of(positions: np.ndarray, normals: np.ndarray) -> SurfaceBounds:
    """The bounds of one tile in which points (P,3) with normals (P,3) are visible."""
    low, high = np.append(positions.min(0), 1.0), np.append(positions.max(0), 0.0)
    normal_cone = np.append(normals[0], (normals @ normals[0]).min())
    return SurfaceBounds.of(*(row.astype(np.float32)[None, None] for row in (low, high, normal_cone)))


@settings(deadline=None, derandomize=True)
@given(seed=st.integers(0, 1 << 30), near=st.floats(-2.0, 1.0), spread=st.floats(0.05, np.pi), tilt=st.floats(0.0, 3.0))
def test_no_light_is_brighter_than_its_bound(seed, near, spread, tilt):
    """Random points with random normals, and a random near or far light, against a sum over the light."""
    random = np.random.default_rng(seed)
    axes = basis(random.normal(size=3))
    points = random.uniform(-1.0, 1.0, (12, 3)) * 10.0 ** random.uniform(-2.0, 0.0, 3)
    normals = axes[2] + tilt * random.normal(size=(12, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    frame, size = basis(random.normal(size=3)), 10.0 ** random.uniform(-2.0, 0.5, 2)
    shape = LightShape(int(random.integers(2)))
    one = light(shape, random.normal(size=3) * 10.0**-near, size[0] * frame[0], size[1] * frame[1], 1.0, spread)
    (bound,), _ = AreaLightBounds.of(one, np.zeros(3)).irradiance(bounds_of(points, normals))
    irradiances = [irradiance(p, n, one, 0, 24) for p, n in zip(points, normals, strict=True)]
    assert max(irradiances) <= 1.05 * bound[0] + 1e-9, "by more than the error of the sum over the light"


def test_far_from_a_light_the_estimate_is_accurate():
    points = np.random.default_rng(0).uniform(-0.05, 0.05, (20, 3)) * (1.0, 1.0, 0.0)
    for shape, spread in zip(AREA_SHAPES, (np.pi, 1.0), strict=True):
        one = light(shape, (0.7, -0.4, 3.0), (0.3, 0, 0), (0, -0.4, 0), 1.0, spread)
        (bound,), (estimate,) = AreaLightBounds.of(one, np.zeros(3)).irradiance(
            bounds_of(points, np.tile((0, 0, 1.0), (20, 1)))
        )
        truth = irradiance(np.zeros(3), np.array([0, 0, 1.0]), one, 0)
        assert estimate[0] == pytest.approx(truth, rel=0.02)
        assert estimate[0] < bound[0] < 2.0 * estimate[0] * (1.0 if shape == LightShape.RECTANGLE else 3.0)


def test_the_bound_is_zero_where_no_light_can_arrive():
    """Behind a light, however close, above the receiver's horizon only, and outside a narrow spread; not elsewhere."""
    floor = bounds_of(np.array([[-0.1, -0.1, 0], [0.1, 0.1, 0]]), np.array([[0, 0, 1.0], [0, 0, 1.0]]))
    facing_away, below = light(axis_v=(0, 1, 0)), light(position=(0, 0, -1.0), axis_v=(0, 1, 0))
    close = light(position=(0.05, 0, 0.02), axis_v=(0, 1, 0))
    beside, above = light(position=(3.0, 0, 2.0), spread=1.0), light(position=(0.5, 0, 2.0), spread=1.0)
    dark = facing_away, close, below, beside
    for one, arrives in (*((each, False) for each in dark), (above, True), (light(), True)):
        assert AreaLightBounds.of(one, np.zeros(3)).irradiance(floor)[0].any() == arrives


def drawn_rooms(device, idle: dict[str, int], samples: int = 8):
    """The room with five lights that contribute, and idle ones."""
    scene, view = rooms(idle, *SIZE)
    return draw(device, scene, view, SMALL_SETTINGS, last=samples - 1)


@pytest.mark.parametrize("why", IDLE)
def test_idle_lights_take_no_work_and_change_nothing(device, why):
    alone, drawn = drawn_rooms(device, {}), drawn_rooms(device, {why: 40})
    expected, color = alone.color[..., :3], drawn.color[..., :3]
    allowed = culling_state.MAX_CULLED_FRACTION if why == "faint" else ROUNDING
    assert np.sqrt(((color - expected) ** 2).mean()) <= allowed * expected.mean()
    assert set(drawn.renderer.graph[TILE_VISIBILITY]) == set(range(5)), (
        "only contributing lights have textures of their own"
    )
    influences = drawn.renderer.graph[LIGHT_INFLUENCE]
    if why in ("turned away", "elsewhere"):
        assert set(influences) == set(range(5)), "their bounds alone cull the others"
    if why == "hidden":
        assert not any(each.coarse_visibility.any() for light, each in influences.items() if light >= 5)


def test_many_lights_that_no_ray_reaches_are_bounded_in_coarse_tiles_only(device, monkeypatch):
    """They change nothing, but some of them are retested."""
    monkeypatch.setattr(cull_lights, "MANY_LIGHTS", 0)
    alone, drawn = drawn_rooms(device, {}), drawn_rooms(device, {"hidden": 60})
    color, expected = drawn.color[..., :3], alone.color[..., :3]
    assert np.sqrt(((color - expected) ** 2).mean()) <= ROUNDING * expected.mean()
    influences, (hidden, relative_bounds) = (drawn.renderer.graph[name] for name in (LIGHT_INFLUENCE, HIDDEN_LIGHTS))
    assert set(range(5)) <= set(influences) and len(influences) < 15
    assert len(hidden) > 30 and not set(influences) & set(hidden)
    assert 0.0 < relative_bounds.sum(0).max() <= COARSE_SIDE**2 * (1.0 + ROUNDING), "together they count as one light"
    assert drawn.profile.counts["retests"] > 0


def hidden_influences(*relative_bounds: float):
    """The influences, in a picture of one tile, of lights that no ray reaches: their bounds over the irradiance."""
    floor = bounds_of(np.zeros((1, 3)), np.array([[0, 0, 1.0]]))
    surfaces, bounds = floor.select([0, 0]), np.array(relative_bounds, np.float32)[:, None, None]
    dark = {light: np.zeros((1, 1), np.float32) for light in range(len(bounds))}
    state = CullingState(surfaces, np.arange(len(bounds)), bounds, HiddenLights.none((1, 1)), dark, np.ones((1, 1)))
    return light_influences(state, has_gloss=False)


def test_a_hidden_light_close_by_hides_no_other():
    lamp, window = hidden_influences(1000.0, 0.5).values()
    assert lamp.to_probe.all() and window.to_probe.all()


@pytest.mark.parametrize("bound", [0.5, 1.0, 100.0])
def test_many_hidden_lights_are_as_one(bound):
    influences = hidden_influences(*[bound] * 40).values()
    assert sum(each.relative_bound.item() for each in influences) == pytest.approx(1.0)
    assert not any(each.to_probe.any() for each in influences)


def test_faint_lights_contribute_if_nothing_is_negligible(device, monkeypatch):
    """So the test above depends on the culled fraction."""
    monkeypatch.setattr(culling_state, "MAX_CULLED_FRACTION", 0.0)
    assert len(drawn_rooms(device, {"faint": 40}, 1).renderer.graph[LIGHT_INFLUENCE]) == 45


def test_a_dark_room_is_lit_by_its_faint_light(device):
    """The light outside is a million times as bright, but occluded: the faint one must not be culled because of it."""
    room = subdivided_box((-3, -3, 0), (3, 3, 3), 2)
    lights = join_lights(light(position=(0, 0, 2.5)), light(position=(0, 0, 9.0), radiance=1e6))
    scene, view = make_scene([room], lights), view_from_above(4.0, SIZE, height=2.8)
    view = replace(view, view_from_world=np.eye(4) + np.pad([[0], [0], [-2.0]], ((0, 1), (3, 0))))
    alone = draw(device, replace(scene, lights=light(position=(0, 0, 2.5))), view, SMALL_SETTINGS).color
    assert alone[..., :3].mean() > 0.01
    assert np.allclose(draw(device, scene, view, SMALL_SETTINGS).color, alone, rtol=1e-4, atol=0.0)


@pytest.mark.parametrize("radiance", [0.1, 0.04], ids=["alone", "by the block"])
def test_light_through_a_hole_that_no_coarse_ray_hits_is_found_in_the_end(device, monkeypatch, radiance):
    """Twenty lights above a screen with a hole, and one below it: the light through the hole converges."""
    monkeypatch.setattr(cull_lights, "MANY_LIGHTS", 0)  # as few coarse rays as a large picture has for its size
    screens = [
        quad((-40, -40, 1.0), (40.3, 0, 0), (0, 80, 0)),
        quad((0.6, -40, 1.0), (40, 0, 0), (0, 80, 0)),
        quad((0.3, -40, 1.0), (0.3, 0, 0), (0, 40.2, 0)),
        quad((0.3, 0.5, 1.0), (0.3, 0, 0), (0, 40, 0)),
    ]
    lights = light(position=(0, 0, 0.95))
    for index in range(20):
        position = 0.3 + 0.02 * index, 0.3, 3.0
        above = light(position=position, axis_u=(0.4, 0, 0), axis_v=(0, -0.4, 0), radiance=radiance)
        lights = join_lights(lights, above)
    scene, view = (
        make_scene([quad((-4, -4, 0), (8, 0, 0), (0, 8, 0)), *screens], lights),
        view_from_above(4.0, (64, 64), height=0.9),
    )
    only_below = replace(scene, lights=light(position=(0, 0, 0.95)))
    unshadowed = replace(scene, instances=replace(scene.instances, casts_shadow=np.array([True] + 4 * [False])))
    settings = with_quality(SMALL_SETTINGS, samples=256)
    before, after, without = (
        draw(device, each, view, settings, last=last).color[..., 0].sum()
        for each, last in ((scene, 0), (scene, 255), (only_below, 0))
    )
    only_above = replace(scene, lights=Lights(**{name: rows[1:] for name, rows in vars(lights).items()}))
    truth = reference.picture(only_above, view, 6)[0][:, 0].sum()
    assert draw(device, unshadowed, view, settings, last=0).color[..., 0].sum() > without + 10.0 * truth
    assert before == pytest.approx(without, rel=1e-6), "a coarse ray hits the hole"
    assert 0.1 * truth < after - without < 1.1 * truth


def test_a_strip_of_light_between_the_coarse_rays_is_in_the_first_picture(device):
    """A slit lights a few pixels by an eighth of the light's bound there: too little to be left to the retests."""
    below = light(position=(0, 0, 0.95), axis_u=(4, 0, 0), axis_v=(0, -4, 0), radiance=0.1)
    beyond = light(position=(0, 0, 3.0), axis_u=(0.01, 0, 0), axis_v=(0, -0.01, 0), radiance=1300.0)
    screens = [quad((-40, -40, 1.0), (40.02, 0, 0), (0, 80, 0)), quad((0.2, -40, 1.0), (40, 0, 0), (0, 80, 0))]
    scene = make_scene([quad((-4, -4, 0), (8, 0, 0), (0, 8, 0)), *screens], join_lights(below, beyond))
    alone = replace(scene, lights=below)
    view, settings = view_from_above(4.0, (64, 64), height=0.9), with_quality(SMALL_SETTINGS, samples=1)
    drawn = draw(device, scene, view, settings)
    assert not drawn.renderer.graph[LIGHT_INFLUENCE][1].coarse_visibility.any(), "a coarse ray hits the slit"
    pictures = drawn.color[..., 0], draw(device, alone, view, settings).color[..., 0]
    truths = [reference.picture(each, view, 8)[0][:, 0].reshape(64, 64) for each in (scene, alone)]
    strip, true_strip = ((lit - unlit)[8:-8, 33:36].mean() for lit, unlit in (pictures, truths))
    assert 0.4 * true_strip < strip < 1.1 * true_strip, "the strip is missing, or stronger than smoothing explains"


def test_faint_lights_with_one_visibility_per_tile_are_unbiased(device, monkeypatch):
    """With no light faint, and with all faint: then the picture must still converge to the reference."""
    scene, view = box_over_plane(48, 32)
    truth, _ = reference.picture(scene, view, 16)
    errors = []
    for faint_fraction in (0.0, np.inf):
        monkeypatch.setattr(culling_state, "FAINT_FRACTION", faint_fraction)
        drawn = draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=256))
        assert bool(drawn.renderer.graph[TILE_VISIBILITY]) == (faint_fraction == 0.0)
        errors.append(reference.nrmse(drawn.color[..., :3].reshape(-1, 3), truth))
    assert errors[1] < 0.05, errors


def test_a_background_has_no_lights(device):
    """None contributes, and none is drawn."""
    drawn = draw(
        device, make_scene([quad((50, 50, 0), (1, 0, 0), (0, 1, 0))], light()), view_from_above(4.0), SMALL_SETTINGS
    )
    assert drawn.renderer.graph[LIGHT_INFLUENCE] == {}
    assert not drawn.target("direct_prediction").any()


def test_more_lights_than_fit_a_strip(device):
    """With a small texture limit their coarse rays are traced in several strips, for all lights including the last."""
    positions = [(x, y, 0.5) for x in np.linspace(-1.5, 1.5, 5) for y in np.linspace(-1.5, 1.5, 5)]
    rows = [light(position=position, axis_u=(0.05, 0.0, 0.0), axis_v=(0.0, -0.05, 0.0)) for position in positions]
    lights = reduce(join_lights, rows)
    floor, plate = (-2.0, -2.0, 0.0), (-0.3, -0.3, 0.2)
    meshes = quad(floor, (4.0, 0.0, 0.0), (0.0, 4.0, 0.0)), quad(plate, (0.6, 0.0, 0.0), (0.0, 0.6, 0.0))
    scene, view, settings = (
        make_scene(meshes, lights),
        view_from_above(4.0, (96, 96)),
        with_quality(SMALL_SETTINGS, samples=2),
    )
    in_strips = draw(replace(device, texture_size=100), scene, view, settings)
    assert -(-view.height // TILE_SIZE // cull_lights.FINE_TILE_SPACING) * len(rows) > 100
    assert in_strips.profile.counts["lights_used"] == len(rows)
    assert np.array_equal(in_strips.color, draw(device, scene, view, settings).color)


@pytest.mark.parametrize("size", [(64, 64), (160, 48)], ids=str)
def test_a_small_picture_loses_no_faint_lights(device, size):
    """An edge occludes half of the floor from many faint lights, and a small picture has few rays."""
    plate, floor = quad((0.0, -4.0, 1.0), (4.0, 0.0, 0.0), (0.0, 8.0, 0.0)), quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))
    bright = light(position=(0.0, 0.0, 4.0), casts_shadow=False)
    scene = make_scene([floor, plate], reduce(join_lights, [light(radiance=0.002)] * 128, bright))
    scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
    view, settings = view_from_above(1.0, size), with_quality(SMALL_SETTINGS, samples=4)
    without = draw(device, make_scene([floor], bright), view, settings).color[..., 0].mean()
    faint = [
        draw(device, scene, view, replace(settings, shortcuts=shortcuts)).color[..., 0].mean() - without
        for shortcuts in (1, 0)
    ]
    assert faint[0] == pytest.approx(faint[1], rel=0.01)


def test_edges_in_tiles_that_the_first_sample_sees_empty_are_lit(device):
    """The edge of a floor is in pixels of the third column of tiles, but not at their centers."""
    floor = quad((-2.0, -2.0, 0.0), (2.0 + 0.3 / 8.0, 0, 0), (0, 4, 0))
    view = replace(view_from_above(4.0, (32, 32), height=0.9), filter_width=1.5)
    unshadowed = replace(with_quality(SMALL_SETTINGS, samples=2), shadow=Shadow(enabled=False))
    color, exact = (
        draw(device, make_scene([floor], light()), view, replace(unshadowed, shortcuts=shortcuts)).color[:, 16, 0]
        for shortcuts in (True, False)
    )
    assert color == pytest.approx(exact, rel=ROUNDING)
