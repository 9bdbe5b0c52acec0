# SPDX-License-Identifier: GPL-3.0-or-later
"""What is drawn again, and what is not; the same request gives the same picture."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.renderer import PASSES, SHOWABLE
from ism_addon.settings import SSAO

from .scenes.small import box_over_plane
from .studio import SMALL_SETTINGS, draw, look, with_quality

SETTINGS = replace(SMALL_SETTINGS, ssao=SSAO())
ALL = {kind.__name__ for kind in PASSES}
SHADOWS = {"Splat", "PullPush", "Gather"}
AFTER = {"Shade", "Accumulate"}


@pytest.fixture
def scene_and_view():
    return box_over_plane(24, 16)


@pytest.fixture
def again(device, scene_and_view):
    """Draws once, and then something else: the names of the passes that the second picture drew."""
    scene, view = scene_and_view
    first = draw(device, scene, view, SETTINGS)

    def passes(scene=scene, view=view, settings=SETTINGS) -> set[str]:
        second = draw(device, scene, view, settings, first.renderer)
        fresh = draw(device, scene, view, settings)
        assert np.array_equal(second.color, fresh.color), "what was used again was out of date"
        return {name for name, row in second.profile.rows.items() if row.drawn}

    return passes


def test_the_first_picture_draws_all_passes(device, scene_and_view):
    drawn = draw(device, *scene_and_view, SETTINGS)
    assert {name for name, row in drawn.profile.rows.items() if row.drawn} == ALL - {"Show"}
    assert drawn.profile.counts["light_points"] == 8
    assert drawn.profile.counts["bytes_uploaded"] > 0


def test_nothing_changed_draws_nothing(again):
    assert again() == set()


def test_equal_settings_draw_nothing(again):
    assert again(settings=replace(SETTINGS, ssao=SSAO(), quality=replace(SETTINGS.quality))) == set()


def test_a_moved_light_keeps_what_the_camera_sees(again, scene_and_view):
    scene, _ = scene_and_view
    lights = replace(scene.lights, position=scene.lights.position + 0.1)
    assert again(replace(scene, lights=lights)) == {"LightPoints", "Subsets"} | SHADOWS | AFTER


def test_a_moved_camera_keeps_the_shadow_maps(again):
    moved = look((3.0, -3.4, 2.6), (0.0, 0.0, 0.3), (24, 16))
    assert again(view=moved) == {"GBuffer", "Gather", "SSAO", "Blur"} | AFTER


def test_a_moved_object_keeps_meshes_and_materials(again, scene_and_view):
    scene, _ = scene_and_view
    matrices = scene.instances.world_from_object.copy()
    matrices[1, 2, 3] += 0.2
    drawn = again(replace(scene, instances=replace(scene.instances, world_from_object=matrices)))
    assert {"Place", "SurfacePoints", "GBuffer", *SHADOWS} <= drawn
    assert not drawn & {"Meshes", "Colours", "LightPoints"}


def test_another_colour_keeps_the_shadows(again, scene_and_view):
    scene, _ = scene_and_view
    materials = replace(scene.materials, base_color=np.array([[0.9, 0.1, 0.1]], np.float32))
    drawn = again(replace(scene, materials=materials))
    assert {"Colours", "GBuffer", "Shade"} <= drawn
    assert not drawn & {"Splat", "PullPush", "SurfacePoints", "Meshes", "LightPoints"}


def test_another_world_is_only_shaded(again, scene_and_view):
    scene, _ = scene_and_view
    assert again(replace(scene, world=replace(scene.world, radiance=np.full(3, 0.4, np.float32)))) == AFTER


@pytest.mark.parametrize(
    ("section", "changes", "expected"),
    [
        ("ssao", {"radius": 0.2}, {"SSAO", "Blur"} | AFTER),
        ("ssao", {"intensity": 2.0}, {"SSAO", "Blur"} | AFTER),
        ("ssao", {"enabled": False}, AFTER),
        ("shadow", {"bias": 2.0}, {"Gather"} | AFTER),
        ("shadow", {"fill_threshold": 0.1}, {"PullPush", "Gather"} | AFTER),
        ("shadow", {"fill_holes": False}, {"Gather"} | AFTER),
        ("shadow", {"splat_size": 2.0}, {"Subsets"} | SHADOWS | AFTER),
        ("shadow", {"enabled": False}, {"Gather"} | AFTER),
        ("quality", {"map_size": 64}, SHADOWS | AFTER),
        ("quality", {"surface_points": 1000}, {"SurfacePoints", "Subsets"} | SHADOWS | AFTER),
        ("quality", {"light_points": 5}, {"LightPoints"} | SHADOWS | AFTER),
    ],
)
def test_a_setting_redraws_its_own_passes(again, section, changes, expected):
    settings = replace(SETTINGS, **{section: replace(getattr(SETTINGS, section), **changes)})
    assert again(settings=settings) == expected


def test_switched_on_again_after_it_was_off(device, scene_and_view):
    """A pass that was left out must not be taken for up to date."""
    scene, view = scene_and_view
    first = draw(device, scene, view, SETTINGS)
    before = first.color
    off = replace(SETTINGS, ssao=replace(SETTINGS.ssao, enabled=False), shadow=replace(SETTINGS.shadow, enabled=False))
    assert not np.array_equal(draw(device, scene, view, off, first.renderer).color, before)
    assert np.array_equal(draw(device, scene, view, SETTINGS, first.renderer).color, before)


def test_another_size_of_picture(device, scene_and_view):
    scene, view = scene_and_view
    first = draw(device, scene, view, SETTINGS)
    larger = replace(view, width=40, height=30)
    second = draw(device, scene, larger, SETTINGS, first.renderer)
    assert np.array_equal(second.color, draw(device, scene, larger, SETTINGS).color)
    assert second.profile.rows["Splat"].drawn == 0


def test_every_sample_has_its_own_light_points(device, scene_and_view):
    drawn = draw(device, *scene_and_view, with_quality(SETTINGS, samples=3))
    rows = drawn.profile.rows
    assert rows["LightPoints"].drawn == rows["Splat"].drawn == rows["GBuffer"].drawn == 3
    assert rows["Meshes"].drawn == rows["SurfacePoints"].drawn == rows["Subsets"].drawn == 1


def test_two_renders_are_bit_identical(device, scene_and_view):
    settings = with_quality(SETTINGS, samples=3)
    one, two = (draw(device, *scene_and_view, settings).color for _ in range(2))
    assert np.array_equal(one, two)


def test_an_interrupted_picture_leaves_no_trace(device, scene_and_view):
    """A request that was dropped in the middle of a sample, and another one drawn after it."""
    from ism_addon.gpu.profile import Profile

    scene, view = scene_and_view
    settings = with_quality(SETTINGS, samples=2)
    whole = draw(device, scene, view, settings)
    expected = whole.color
    other = replace(scene, lights=replace(scene.lights, position=scene.lights.position + 0.3))
    for steps in (1, 5, 8, 10, 12):
        drawing = whole.renderer.sample(other, view, settings, 0, Profile())
        for _ in range(steps):
            next(drawing)
        drawing.close()
        assert np.array_equal(draw(device, scene, view, settings, whole.renderer).color, expected), steps


@pytest.mark.parametrize("target", SHOWABLE)
def test_every_target_can_be_shown(device, scene_and_view, target):
    shown = draw(device, *scene_and_view, replace(SETTINGS, show=target)).color
    assert shown.shape == (16, 24, 4)
    assert np.isfinite(shown).all()


@pytest.mark.parametrize("off", ["ssao", "shadow"])
def test_targets_that_nobody_drew_can_be_shown(device, scene_and_view, off):
    settings = replace(SETTINGS, **{off: replace(getattr(SETTINGS, off), enabled=False)})
    for target in SHOWABLE:
        assert np.isfinite(draw(device, *scene_and_view, replace(settings, show=target)).color).all()
