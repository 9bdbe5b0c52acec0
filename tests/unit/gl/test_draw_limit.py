# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws are split so that none exceeds a driver's timeout, whatever the settings; usual pictures are not split."""

import math
import platform
import sys
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.gl import draw_limit
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.gl.draw_limit import portions, rectangles
from ism_addon.gpu.graph import Graph
from ism_addon.gpu.passes.film.accumulate import rays_for
from ism_addon.gpu.passes.shadow_maps.gather import VIRTUAL_LIGHTS_PER_RAY
from ism_addon.gpu.passes.shadow_maps.splat import MAP_TEXELS_PER_RAY, RAYS_PER_DISC
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.gpu.submission import Submission
from ism_addon.resources import MAP_POINTS, NO_OCCLUDER, TILE_SIZE
from ism_addon.sampling.pixel_grid import filter_margin
from ism_addon.scene import World
from ism_addon.settings import SSAO
from tests.scenes.small import box_over_plane, sphere_in_corner
from tests.support import gl_calls
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw, join_lights, with_quality, with_shadow

#: Rays per draw: so few that all passes of a small picture are drawn in portions.
MAX_RAYS = 100

#: Rays per pixel of GatherLight, with as many virtual lights as a sample may have.
MAX_GATHER_RAYS = (1 + 1 + 4096) / VIRTUAL_LIGHTS_PER_RAY

counts_draws = pytest.mark.skipif(
    sys.platform != "linux" or platform.machine() not in gl_calls.STUBS, reason="counts by machine code, under Linux"
)


@pytest.fixture
def draw_rays(monkeypatch) -> dict[str, list[float]]:
    """By pass, the rays of each draw."""
    step, before_draw, current_pass, draw_rays = Graph.step, Submission.before_draw, [""], {}

    def recorded_step(self, pass_type, frame, profile):
        current_pass[0] = pass_type.__name__
        step(self, pass_type, frame, profile)

    def recorded_before_draw(self, rays):
        draw_rays.setdefault(current_pass[0], []).append(rays)
        before_draw(self, rays)

    monkeypatch.setattr(Graph, "step", recorded_step)
    monkeypatch.setattr(Submission, "before_draw", recorded_before_draw)
    return draw_rays


def lit_by_many(width: int, height: int):
    """Bright lights and faint ones, and a sky, so that all passes draw."""
    scene, view = sphere_in_corner(width, height)
    one = lights = scene.lights
    for k in range(4):
        lights = join_lights(
            lights, replace(one, position=one.position + 0.1 * k, emission=one.emission * np.float32(2e-3))
        )
    return replace(scene, lights=lights, world=World.even(np.full(3, 0.1, np.float32))), view


CASES = {
    "by rays": (SMALL_SETTINGS, 1.5),
    "by a wide filter": (SMALL_SETTINGS, 9.0),
    "by maps": (with_quality(SMALL_SHADOW_MAPS, map_size=64, virtual_lights=12), 0.01),
}


@pytest.mark.parametrize("case", CASES)
def test_a_picture_in_portions_is_the_same(device, monkeypatch, draw_rays, case):
    settings, filter_width = CASES[case]
    settings = with_quality(replace(settings, ssao=SSAO(enabled=True)), samples=4)
    scene, view = lit_by_many(200, 112)
    view = replace(view, filter_width=filter_width)
    expected = draw(device, scene, view, settings).color
    draws = {name: len(rays) for name, rays in draw_rays.items()}
    draw_rays.clear()
    monkeypatch.setattr(draw_limit, "MAX_RAYS_PER_DRAW", MAX_RAYS)
    assert np.array_equal(draw(device, scene, view, settings).color, expected)
    assert draw_rays.keys() == draws.keys()
    assert all(len(rays) > draws[name] for name, rays in draw_rays.items())
    assert all(rays <= MAX_RAYS for of_pass in draw_rays.values() for rays in of_pass)


@counts_draws
@pytest.mark.parametrize("case", CASES)
def test_every_draw_is_announced(monkeypatch, draw_rays, case):
    """Each draw call passes Submission.before_draw, except those of triangles, which are split in another way."""
    calls = gl_calls.count_calls(monkeypatch)
    device = open_device()
    settings, filter_width = CASES[case]
    settings = replace(settings, ssao=SSAO(enabled=True))
    renderer, (scene, view) = Renderer(device), lit_by_many(120, 72)
    triangles, draw_triangles = [], device.draw
    object.__setattr__(device, "draw", lambda *args: triangles.append(args) or draw_triangles(*args))
    before = calls[0].counts
    for sample in range(3):
        list(renderer.sample(scene, replace(view, filter_width=filter_width), settings, sample, Profile()))
    renderer.submission.finish()
    drawn = calls[0].counts - before
    assert drawn["glDrawArraysInstanced"] == sum(map(len, draw_rays.values())) + len(triangles) > 20
    device.close()


def test_a_usual_picture_is_not_split(device, draw_rays):
    """1280×720 pixels, one light, Blender's default filter: each pass has as many draws as for a small picture."""
    draws = []
    for size in ((64, 36), (1280, 720)):
        scene, view = box_over_plane(*size)
        draw(device, scene, replace(view, filter_width=1.5), with_quality(SMALL_SETTINGS, samples=2))
        draws.append({name: len(rays) for name, rays in draw_rays.items()})
        draw_rays.clear()
    assert draws[0] == draws[1]
    assert draws[0]["TraceShadows"] == 1 + 2 * 2  # after the first picture, one for tiles with rays, one for others


def test_portions_are_as_few_as_possible():
    assert [part.stop - part.start for part in portions(10, draw_limit.MAX_RAYS_PER_DRAW / 4)] == [4, 4, 2]
    assert list(portions(3, 10.0 * draw_limit.MAX_RAYS_PER_DRAW)) == [slice(0, 1), slice(1, 2), slice(2, 3)]
    assert list(portions(0, 1.0)) == []


@pytest.mark.parametrize(
    ("size", "rays", "draws"),
    [
        ((1280, 720), 1.0, 1),
        ((3840, 2160), 1.0, 8),
        ((3840, 2160), MAX_GATHER_RAYS, 2160),
        ((16384, 1), MAX_GATHER_RAYS, 4),
    ],
)
def test_rectangles_of_large_pictures(size, rays, draws):
    """Also of GatherLight with the most virtual lights: a row each, or less where a row is too much."""
    portions_drawn = list(rectangles(size, rays))
    assert len(portions_drawn) == draws
    assert all(rays * width * height <= draw_limit.MAX_RAYS_PER_DRAW for _, _, width, height in portions_drawn)
    drawn = np.zeros(size[::-1], np.uint8)
    for x, y, width, height in portions_drawn:
        drawn[y : y + height, x : x + width] += 1
    assert (drawn == 1).all()


@pytest.mark.parametrize("filter_width", [1.5, 4.4])
def test_accumulation_with_a_wide_filter(device, monkeypatch, draw_rays, filter_width):
    """The first sample, twice, draws only a tile's own pixels; later ones also those within the filter's margin."""
    scene, view = box_over_plane(96, 64)
    monkeypatch.setattr(draw_limit, "MAX_RAYS_PER_DRAW", 5000)
    draw(device, scene, replace(view, filter_width=filter_width), with_quality(SMALL_SETTINGS, samples=2))
    margin = filter_margin(filter_width)
    pixel_rays = rays_for((2 * margin + 1) ** 2)
    tile_rays = pixel_rays * (TILE_SIZE + 2 * margin) ** 2
    assert len(draw_rays["Accumulate"]) == 2 * draw_count(96, pixel_rays * TILE_SIZE**2) + draw_count(96, tile_rays)
    assert draw_rays["Accumulate"][-1] <= 5000


def draw_count(count: int, rays: float) -> int:
    """Draws of `count` items of so many rays each."""
    return math.ceil(count / int(draw_limit.MAX_RAYS_PER_DRAW / rays))


def test_discs_of_the_largest_maps(device, draw_rays, monkeypatch):
    """Splats are split by count and by size: a few that are as large as the map take as long as many small ones."""
    scene, view = box_over_plane(16, 9)
    small = with_quality(with_shadow(), virtual_lights=1, map_size=64, map_points=3000)
    large = with_quality(with_shadow(splat_size=8.0), virtual_lights=1, map_size=1024, map_points=3000)
    draws = []
    monkeypatch.setattr(draw_limit, "MAX_RAYS_PER_DRAW", 1 << 14)
    for settings in (small, large):
        drawn = draw(device, scene, view, settings)
        table = drawn.renderer.graph[MAP_POINTS].ranges
        (subset,) = table[0][:1]
        texels = subset.maps * settings.quality.map_size**2
        draws.append(len(draw_rays.pop("SplatMaps")))
        assert draws[-1] == draw_count(subset.count, RAYS_PER_DISC + texels / subset.count / MAP_TEXELS_PER_RAY)
        discs = drawn.target("shadow_map_splats")
        assert texels > (discs < NO_OCCLUDER).sum()
    assert draws[0] == 1
    assert draws[1] > 10
