# SPDX-License-Identifier: GPL-3.0-or-later
"""Edges of emission that the camera sees: filtered by camera rays, unbiased, and only where there are any."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.emission.filter_emission import FilterEmission
from ism_addon.gpu.profile import Profile
from ism_addon.resources import EMISSION_CONTRAST, FILTERED_EMISSION, SAMPLE_EMISSION
from ism_addon.sampling.pixel_grid import filtered
from ism_addon.scene import LightShape
from tests.scenes.parts.tables import instances_of, materials_of
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    draw,
    light,
    look_at,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)

SIZE = 64
VIEW = view_from_above(2.0, (SIZE, SIZE), filter_width=1.5)
FLOOR = quad((-4, -4, 0), (8, 0, 0), (0, 8, 0))
#: A rotated square over the floor, which emits: its corner and sides.
CORNER, U, V = np.array([-0.5, -0.3, 0.5]), np.array([0.9, 0.25, 0.0]), np.array([-0.25, 0.9, 0.0])
LAMP = replace(quad(CORNER, U, V), materials=np.ones(2, np.uint32))
RADIANCE = 10.0


def lamp_scene(*others, **changes):
    """A black floor, the lamp, and others; and a faint light that casts shadows."""
    scene = make_scene([FLOOR, LAMP, *others], light(radiance=1e-6))
    materials = materials_of([(0, 0, 0), (0, 0, 0)], emission=[(0, 0, 0), (RADIANCE,) * 3])
    return replace(scene, materials=materials, instances=instances_of(range(len(scene.meshes)), **changes))


def coverage(view) -> np.ndarray:
    """(H,W): the fraction of each pixel's filter that the lamp covers."""
    uniform = (np.arange(64) + 0.5) / 64
    offsets = filtered(uniform, view.filter_width)
    centres = np.arange(SIZE)[:, None] + 0.5
    # Of a view from above, rows are y and columns are x.
    world = ((centres + offsets).ravel() / SIZE - 0.5) * 2.0
    x, y = world[None, :] - CORNER[0], world[:, None] - CORNER[1]
    area = U[0] * V[1] - U[1] * V[0]
    s, t = (x * V[1] - y * V[0]) / area, (y * U[0] - x * U[1]) / area
    inside = (s > 0.0) & (s < 1.0) & (t > 0.0) & (t < 1.0)
    return inside.reshape(SIZE, 64, SIZE, 64).mean((1, 3))


def edge_error(color: np.ndarray, expected: np.ndarray) -> float:
    """RMSE of emission at the lamp's edges, relative to its radiance."""
    edges = (expected > 0.0) & (expected < 1.0)
    return float(np.sqrt(np.mean((color[..., 0] / RADIANCE - expected)[edges] ** 2)))


def without_camera_rays(monkeypatch) -> None:
    monkeypatch.setattr(FilterEmission, "needed", lambda *_: False)


@pytest.mark.parametrize(("width", "max_error"), [(0.4, 0.02), (1.5, 0.005), (4.0, 0.002)])
def test_edges_are_nearer_to_the_filtered_ones(device, monkeypatch, width, max_error):
    """After 16 samples by far; and after 8, when positions of samples alone leave much, by a factor of three."""
    view, scene = replace(VIEW, filter_width=width), lamp_scene()
    expected = coverage(view)

    def error(samples: int) -> float:
        drawn = draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=samples))
        return edge_error(drawn.color, expected)

    assert error(16) < max_error
    filtered_error = error(8)
    without_camera_rays(monkeypatch)
    assert filtered_error < 0.35 * error(8)


def test_filters_cover_what_is_beside_the_picture(device):
    """The lamp ends six tenths of a pixel before the picture's border."""
    end = 1.0 - 0.6 * 2.0 / SIZE
    lamp = replace(quad((-end, -end, 0.5), (2 * end, 0, 0), (0, 2 * end, 0)), materials=LAMP.materials)
    scene = lamp_scene()
    scene = replace(scene, meshes=(FLOOR, lamp))
    color = draw(device, scene, VIEW, with_quality(SMALL_SETTINGS, samples=16)).color[..., 0] / RADIANCE
    seen = float((np.abs(filtered((np.arange(4096) + 0.5) / 4096, 1.5)) >= 0.1).mean()) / 2.0
    assert color[2:-2, 2:-2].min() > 1.0 - 1e-4
    for border in (color[0], color[-1], color[:, 0], color[:, -1]):
        assert border[1:-1] == pytest.approx(seen, abs=0.03)


def test_the_first_sample_has_filtered_edges(device):
    assert edge_error(draw(device, lamp_scene(), VIEW).color, coverage(VIEW)) < 0.04


def test_nothing_is_left_of_the_difference(device, monkeypatch):
    """Of many samples the mean is the same with and without camera rays."""
    settings = with_quality(SMALL_SETTINGS, samples=128)
    ours = draw(device, lamp_scene(), VIEW, settings).color
    without_camera_rays(monkeypatch)
    theirs = draw(device, lamp_scene(), VIEW, settings).color
    assert abs(ours - theirs).max() < 0.02 * RADIANCE
    assert abs((ours - theirs).mean()) < 1e-4 * RADIANCE


def test_camera_rays_are_traced_only_at_edges(device):
    filtered_tiles = draw(device, lamp_scene(), VIEW).target("filtered_emission")[..., 3] > 0.0
    expected = coverage(VIEW)
    edges = (expected > 0.01) & (expected < 0.99)
    assert filtered_tiles[edges].all()
    assert 0.1 < filtered_tiles.mean() < 0.7


def test_faint_edges_need_no_camera_rays(device):
    """From the second sample on, when the mean luminance is known."""
    scene = replace(lamp_scene(), lights=light(radiance=1e6))
    scene = replace(scene, materials=replace(scene.materials, base_color=np.full((2, 3), 0.5, np.float32)))
    drawn = draw(device, scene, VIEW, with_quality(SMALL_SETTINGS, samples=2))
    assert not drawn.target("filtered_emission")[..., 3].any()


def test_a_light_that_the_camera_sees_is_filtered(device):
    lamp = light(LightShape.RECTANGLE, CORNER + 0.5 * (U + V), U, V, RADIANCE, visible_camera=True)
    scene = make_scene([FLOOR], lamp, base_color=(0, 0, 0))
    drawn = draw(device, scene, VIEW, with_quality(SMALL_SETTINGS, samples=16))
    assert edge_error(drawn.color, coverage(VIEW)) < 0.005


def test_without_emission_there_are_no_passes_and_no_targets(device):
    drawn = draw(device, make_scene([FLOOR], light()), VIEW)
    rows, targets = drawn.profile.rows.keys(), drawn.renderer.graph.targets.sizes
    for name in ("ShadeEmission", "FindEmissionEdges", "FilterEmission"):
        assert name not in rows
    assert not targets.keys() & {SAMPLE_EMISSION, EMISSION_CONTRAST, FILTERED_EMISSION}


def test_what_camera_rays_cannot_find_is_not_filtered(device):
    """A visible instance that casts no shadow is not in the BVH."""
    plate = quad((-0.2, -0.2, 0.8), (0.4, 0, 0), (0, 0.4, 0))
    seen = draw(device, lamp_scene(plate), VIEW)
    assert seen.profile.rows["FilterEmission"].drawn == 1
    unfiltered = draw(device, lamp_scene(plate, casts_shadow=[True, True, False]), VIEW)
    assert unfiltered.profile.rows["FilterEmission"].drawn == 0
    assert not unfiltered.color[SIZE // 2, SIZE // 2, :3].any(), "the plate hides the lamp"


def test_invisible_casters_do_not_hide_emission(device):
    plate = quad((-0.2, -0.2, 0.8), (0.4, 0, 0), (0, 0.4, 0))
    plain = draw(device, lamp_scene(), VIEW).color
    hidden = draw(device, lamp_scene(plate, visible=[True, True, False]), VIEW)
    assert hidden.profile.rows["FilterEmission"].drawn == 1
    assert hidden.color == pytest.approx(plain, abs=1e-3)


@pytest.mark.parametrize("position", [(0.3, -3.0, 2.5), (0.0, -40.0, 30.0)], ids=["near", "far"])
def test_a_perspective_camera_sees_the_same(device, monkeypatch, position):
    """Half of the lamp is behind a plate. Another one is nearer than the near plane, and hides nothing."""
    distance = np.linalg.norm(position)
    view = look_at(position, (0.0, 0.2, 0.5), (48, 36), 2.5 / distance, filter_width=1.5)
    towards = -np.array(position) / distance
    plate = quad((-0.2, -1.0, 0.8), (1.5, 0, 0), (0, 2.0, 0))
    cut = quad(position + 0.05 * towards - (0.5, 0.0, 0.5), (1, 0, 0), (0, 0, 1))
    settings = with_quality(SMALL_SETTINGS, samples=16)
    ours = draw(device, lamp_scene(plate, cut), view, settings)
    without_camera_rays(monkeypatch)
    theirs = draw(device, lamp_scene(plate, cut), view, with_quality(settings, samples=256)).color[..., 0]
    edges = ours.target("filtered_emission")[..., 3] > 0.0
    assert edges.any() and theirs.max() > 0.9 * RADIANCE
    assert np.sqrt(np.mean((ours.color[..., 0] - theirs)[edges] ** 2)) < 0.005 * RADIANCE


def test_positions_of_all_samples_differ(device):
    """Each sample has its own camera rays."""
    renderer_settings = with_quality(SMALL_SETTINGS, samples=2)
    drawn = draw(device, lamp_scene(), VIEW, renderer_settings, last=0)
    first = drawn.target("filtered_emission").copy()
    for _ in drawn.renderer.sample(lamp_scene(), VIEW, renderer_settings, 1, Profile()):
        pass
    assert (drawn.target("filtered_emission") != first).any()
