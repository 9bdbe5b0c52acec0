# SPDX-License-Identifier: GPL-3.0-or-later
"""No draw takes as long as a driver waits for one, whatever is asked for; and usual pictures are drawn at once."""

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
from ism_addon.gpu.passes.film.accumulate import filter_margin, rays_for
from ism_addon.gpu.passes.shadow_maps.gather import VIRTUAL_LIGHTS_PER_RAY
from ism_addon.gpu.passes.shadow_maps.splat import MAP_TEXELS_PER_RAY, RAYS_PER_DISC
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.gpu.submission import Submission
from ism_addon.resources import MAP_POINTS, NO_OCCLUDER, TILE_SIZE
from ism_addon.scene import World
from ism_addon.settings import SSAO
from tests.scenes.small import box_over_plane, sphere_in_corner
from tests.support import gl_calls
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw, join_lights, with_quality, with_shadow

#: Rays: so few that all passes of a small picture are drawn in portions.
FEW = 100

#: Rays of a pixel of GatherLight, with as many virtual lights as a sample may have.
MOST_POINTS = (1 + 1 + 4096) / VIRTUAL_LIGHTS_PER_RAY

counts_draws = pytest.mark.skipif(
    sys.platform != "linux" or platform.machine() not in gl_calls.STUBS, reason="counts by machine code, under Linux"
)


@pytest.fixture
def asked(monkeypatch) -> dict[str, list[float]]:
    """By pass, the rays of each draw."""
    step, ask, now, asked = Graph.step, Submission.before_draw, [""], {}

    def step_and_say(self, kind, frame, profile):
        now[0] = kind.__name__
        step(self, kind, frame, profile)

    def ask_and_note(self, rays):
        asked.setdefault(now[0], []).append(rays)
        ask(self, rays)

    monkeypatch.setattr(Graph, "step", step_and_say)
    monkeypatch.setattr(Submission, "before_draw", ask_and_note)
    return asked


def lit_by_many(width: int, height: int):
    """Bright lights and faint ones, by a sky: something for all passes."""
    scene, view = sphere_in_corner(width, height)
    one = lights = scene.lights
    for k in range(4):
        lights = join_lights(
            lights, replace(one, position=one.position + 0.1 * k, radiance=one.radiance * np.float32(2e-3))
        )
    return replace(scene, lights=lights, world=World(np.full(3, 0.1, np.float32))), view


CASES = {
    "by rays": (SMALL_SETTINGS, 1.5),
    "by a wide filter": (SMALL_SETTINGS, 9.0),
    "by maps": (with_quality(SMALL_SHADOW_MAPS, map_size=64, virtual_lights=12), 0.01),
}


@pytest.mark.parametrize("case", CASES)
def test_a_picture_in_portions_is_the_same(device, monkeypatch, asked, case):
    settings, filter_width = CASES[case]
    settings = with_quality(replace(settings, ssao=SSAO(enabled=True)), samples=4)
    scene, view = lit_by_many(200, 112)
    view = replace(view, filter_width=filter_width)
    whole, draws = draw(device, scene, view, settings).color, {name: len(rays) for name, rays in asked.items()}
    asked.clear()
    monkeypatch.setattr(draw_limit, "MAX_RAYS_PER_DRAW", FEW)
    assert np.array_equal(draw(device, scene, view, settings).color, whole)
    assert asked.keys() == draws.keys()
    assert all(len(rays) > draws[name] for name, rays in asked.items())
    assert all(rays <= FEW for of_pass in asked.values() for rays in of_pass)


@counts_draws
@pytest.mark.parametrize("case", CASES)
def test_every_draw_is_asked_for(monkeypatch, asked, case):
    """But for the triangles, which have portions of their own, so that none can be forgotten."""
    calls = gl_calls.count_calls(monkeypatch)
    device = open_device()
    settings, filter_width = CASES[case]
    settings = replace(settings, ssao=SSAO(enabled=True))
    renderer, (scene, view) = Renderer(device), lit_by_many(120, 72)
    triangles, draw_triangles = [], device.draw
    object.__setattr__(device, "draw", lambda *parts: triangles.append(parts) or draw_triangles(*parts))
    before = calls[0].counts
    for sample in range(3):
        list(renderer.sample(scene, replace(view, filter_width=filter_width), settings, sample, Profile()))
    renderer.submission.finish()
    drawn = calls[0].counts - before
    assert drawn["glDrawArraysInstanced"] == sum(map(len, asked.values())) + len(triangles) > 20
    device.close()


def test_a_usual_picture_is_drawn_at_once(device, asked):
    """As many draws of each pass as of a small one: 1280×720 pixels under one light, by Blender's usual filter."""
    found = []
    for size in ((64, 36), (1280, 720)):
        scene, view = box_over_plane(*size)
        draw(device, scene, replace(view, filter_width=1.5), with_quality(SMALL_SETTINGS, samples=2))
        found.append({name: len(rays) for name, rays in asked.items()})
        asked.clear()
    assert found[0] == found[1]
    assert found[0]["TraceShadows"] == 1 + 2  # of the second sample, where rays are and where not


def test_draws_are_as_few_as_they_can_be():
    assert [part.stop - part.start for part in portions(10, draw_limit.MAX_RAYS_PER_DRAW / 4)] == [4, 4, 2]
    assert list(portions(3, 10.0 * draw_limit.MAX_RAYS_PER_DRAW)) == [slice(0, 1), slice(1, 2), slice(2, 3)]
    assert list(portions(0, 1.0)) == []


@pytest.mark.parametrize(
    ("size", "rays", "draws"),
    [((1280, 720), 1.0, 1), ((3840, 2160), 1.0, 8), ((3840, 2160), MOST_POINTS, 2160), ((16384, 1), MOST_POINTS, 4)],
)
def test_pixels_of_large_pictures(size, rays, draws):
    """GatherLight's of most virtual lights, too: a row each, or less where that is too much."""
    found = list(rectangles(size, rays))
    assert len(found) == draws
    assert all(rays * width * height <= draw_limit.MAX_RAYS_PER_DRAW for _, _, width, height in found)
    drawn = np.zeros(size[::-1], np.uint8)
    for x, y, width, height in found:
        drawn[y : y + height, x : x + width] += 1
    assert (drawn == 1).all()


@pytest.mark.parametrize("reach", [1.5, 4.4])
def test_sums_of_a_wide_filter(device, monkeypatch, asked, reach):
    """A block's samples count for pixels around it, but for the first: for so many more, each of so many."""
    scene, view = box_over_plane(96, 64)
    monkeypatch.setattr(draw_limit, "MAX_RAYS_PER_DRAW", 5000)
    draw(device, scene, replace(view, filter_width=reach), with_quality(SMALL_SETTINGS, samples=2))
    around = filter_margin(reach)
    a_pixel = rays_for((2 * around + 1) ** 2)
    a_block = a_pixel * (TILE_SIZE + 2 * around) ** 2
    assert len(asked["Accumulate"]) == draws_of(96, a_pixel * TILE_SIZE**2) + draws_of(96, a_block)
    assert asked["Accumulate"][-1] <= 5000


def draws_of(count: int, rays: float) -> int:
    return math.ceil(count / int(draw_limit.MAX_RAYS_PER_DRAW / rays))


def test_discs_of_the_largest_maps(device, asked, monkeypatch):
    """Discs are drawn by number and by size: a few that are as large as the map take as long as many small ones."""
    scene, view = box_over_plane(16, 9)
    small = with_quality(with_shadow(), virtual_lights=1, map_size=64, map_points=3000)
    large = with_quality(with_shadow(splat_size=8.0), virtual_lights=1, map_size=1024, map_points=3000)
    found = []
    monkeypatch.setattr(draw_limit, "MAX_RAYS_PER_DRAW", 1 << 14)
    for settings in (small, large):
        drawn = draw(device, scene, view, settings)
        table = drawn.renderer.graph[MAP_POINTS].ranges
        (subset,) = table[0][:1]
        texels = subset.maps * settings.quality.map_size**2
        found.append(len(asked.pop("SplatMaps")))
        assert found[-1] == draws_of(subset.count, RAYS_PER_DISC + texels / subset.count / MAP_TEXELS_PER_RAY)
        discs = drawn.target("shadow_map_splats")
        assert texels > (discs < NO_OCCLUDER).sum()
    assert found[0] == 1
    assert found[1] > 10
