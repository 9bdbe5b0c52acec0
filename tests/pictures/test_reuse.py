# SPDX-License-Identifier: GPL-3.0-or-later
"""What another setting has drawn again, and what is not; the same request gives the same picture. See test_edits."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu import renderer
from ism_addon.gpu.estimators import RayTracedDirect, ShadowMappedDirect
from ism_addon.resources import INSTANCE_BUFFERS, MATERIAL_BUFFERS, MESH_BUFFERS
from ism_addon.scene import Image
from ism_addon.settings import SSAO, DebugView, Method
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)

SETTINGS = replace(SMALL_SETTINGS, ssao=SSAO())
BY_MAPS = replace(SMALL_SHADOW_MAPS, ssao=SSAO())
METHODS = {method.label: settings for method, settings in zip(Method, (SETTINGS, BY_MAPS), strict=True)}
TREES = {"BuildBLAS", "UploadBLAS", "BuildTLAS"}
STAGES = *renderer.UPLOAD, *renderer.SURFACES, *renderer.SELECTION
BEFORE = {kind.__name__ for kind in STAGES} - TREES - {"UploadUVs"}
LIGHT = {kind.__name__ for kind in RayTracedDirect.pass_types} - {"RetestOccluded"}  # nothing to retest yet
RAYS = TREES | LIGHT
SHADOWS = {kind.__name__ for kind in ShadowMappedDirect.FOR_EACH_ATLAS}
ALL_MAPS = {kind.__name__ for kind in ShadowMappedDirect.pass_types}
OCCLUSION = {"AmbientOcclusion", "BlurOcclusion"}
WANTED = {"CullMeshes"}
AFTER = {"Shade", "Accumulate", "Resolve", "EstimateError"}


@pytest.fixture
def scene_and_view():
    return box_over_plane(24, 16)


@pytest.fixture(params=METHODS)
def base(request):
    """The settings of one method."""
    return METHODS[request.param]


@pytest.fixture
def again(device, scene_and_view):
    """Draws once, and then something else: the names of the passes that the second picture drew."""
    scene, view = scene_and_view

    def passes(before=SETTINGS, scene=scene, view=view, after=None) -> set[str]:
        first = draw(device, *scene_and_view, before)
        assert first.color.any()
        second = draw(device, scene, view, after or before, first.renderer)
        fresh = draw(device, scene, view, after or before)
        assert np.array_equal(second.color, fresh.color), "what was used again was out of date"
        return {name for name, row in second.profile.rows.items() if row.drawn}

    return passes


@pytest.mark.parametrize(("settings", "expected"), [(SETTINGS, RAYS), (BY_MAPS, ALL_MAPS)], ids=METHODS)
def test_the_first_picture_draws_the_passes_of_its_method(device, scene_and_view, settings, expected):
    drawn = draw(device, *scene_and_view, settings)
    assert drawn.color.any()
    assert {name for name, row in drawn.profile.rows.items() if row.drawn} == BEFORE | expected | OCCLUSION | AFTER
    assert drawn.profile.counts["virtual_lights"] == (8 if settings == BY_MAPS else 0)
    assert drawn.profile.counts["bytes_uploaded"] > 0


def test_renderers_share_what_they_have_of_one_scene(device, scene_and_view):
    first, second = (draw(device, *scene_and_view, SETTINGS) for _ in range(2))
    for resource in (MESH_BUFFERS, MATERIAL_BUFFERS):
        assert first.renderer.graph[resource] is second.renderer.graph[resource]
    uploaded = [drawn.profile.counts["bytes_uploaded"] for drawn in (first, second)]
    owners, others = (drawn.renderer.graph[INSTANCE_BUFFERS].owners for drawn in (first, second))
    assert owners is others
    geometry, surfaces = first.renderer.graph[MESH_BUFFERS], first.renderer.graph[MATERIAL_BUFFERS]
    shared = (geometry, owners, surfaces, surfaces.texels)
    assert uploaded[0] - uploaded[1] == sum(each.bytes for each in shared)


def test_another_colour_uploads_no_image(device):
    texels = np.random.default_rng(0).integers(0, 256, (64, 64, 4), np.uint8)
    scene, view = (
        make_scene([quad((-1.0, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0))], image=Image(texels)),
        view_from_above(2.0),
    )
    first = draw(device, scene, view)
    materials = replace(scene.materials, base_color=scene.materials.base_color / 2.0)
    second = draw(device, replace(scene, materials=materials), view, renderer=first.renderer)
    assert second.profile.rows["UploadMaterials"].drawn
    assert first.profile.counts["bytes_uploaded"] > texels.nbytes
    assert second.profile.counts["bytes_uploaded"] == second.renderer.graph[MATERIAL_BUFFERS].bytes


def test_equal_settings_draw_nothing(again, base):
    assert again(base, after=replace(base, ssao=SSAO(), quality=replace(base.quality))) == set()


def test_another_world_is_only_shaded(again, scene_and_view, base):
    scene, _ = scene_and_view
    assert again(base, replace(scene, world=replace(scene.world, radiance=np.full(3, 0.4, np.float32)))) == AFTER


def test_the_other_method_keeps_what_the_camera_sees(again):
    assert again(SETTINGS, after=BY_MAPS) >= ALL_MAPS | {"SelectTiles", "Shade", "Accumulate"}
    assert again(BY_MAPS, after=SETTINGS) >= RAYS | {"SelectTiles", "Shade", "Accumulate"}
    assert not again(SETTINGS, after=BY_MAPS) & {"UploadMeshes", "UploadInstances", "UploadMaterials"}
    assert "UploadMaterials" not in again(BY_MAPS, after=SETTINGS), (
        "rays want triangles in an order of their own, but no more"
    )


@pytest.mark.parametrize(
    ("section", "changes", "by_rays", "by_maps"),
    [
        ("ssao", {"radius": 0.2}, OCCLUSION | AFTER, OCCLUSION | AFTER),
        ("ssao", {"intensity": 2.0}, OCCLUSION | AFTER, OCCLUSION | AFTER),
        ("ssao", {"enabled": False}, AFTER, AFTER),
        ("shadow", {"bias": 2.0}, set(), {"GatherLight"} | AFTER),
        ("shadow", {"fill_threshold": 0.1}, set(), {"FillHoles", "GatherLight"} | AFTER),
        ("shadow", {"fill_holes": False}, set(), {"GatherLight"} | AFTER),
        ("shadow", {"splat_size": 2.0}, set(), {"SelectPoints"} | SHADOWS | AFTER),
        (
            "shadow",
            {"enabled": False},
            {"CullMeshes", "CullLights", "SelectFaintLights", "TraceShadows"} | AFTER,
            {"CullMeshes", "PlaceVirtualLights", "GatherLight"} | AFTER,
        ),
        ("quality", {"map_size": 64}, set(), SHADOWS | AFTER),
        ("quality", {"map_points": 1000}, set(), ALL_MAPS | AFTER),
        ("quality", {"virtual_lights": 5}, set(), {"PlaceVirtualLights"} | SHADOWS | AFTER),
    ],
)
def test_a_setting_redraws_its_own_passes(again, section, changes, by_rays, by_maps):
    for before, expected in ((SETTINGS, by_rays), (BY_MAPS, by_maps)):
        after = replace(before, **{section: replace(getattr(before, section), **changes)})
        assert again(before, after=after) == expected


def test_switched_on_again_after_it_was_off(device, scene_and_view, base):
    """A pass that was left out must not be taken for up to date."""
    scene, view = scene_and_view
    first = draw(device, scene, view, base)
    before = first.color
    off = replace(base, ssao=replace(base.ssao, enabled=False), shadow=replace(base.shadow, enabled=False))
    assert not np.array_equal(draw(device, scene, view, off, first.renderer).color, before)
    assert np.array_equal(draw(device, scene, view, base, first.renderer).color, before)


def test_another_size_of_picture(device, scene_and_view, base):
    scene, view = scene_and_view
    first = draw(device, scene, view, base)
    larger = replace(view, width=40, height=30)
    second = draw(device, scene, larger, base, first.renderer)
    assert np.array_equal(second.color, draw(device, scene, larger, base).color)
    assert second.profile.rows["SplatMaps"].drawn == second.profile.rows["BuildTLAS"].drawn == 0


def test_every_sample_has_its_own_light_points(device, scene_and_view):
    rows = draw(device, *scene_and_view, with_quality(BY_MAPS, samples=3)).profile.rows
    assert rows["PlaceVirtualLights"].drawn == rows["SplatMaps"].drawn == rows["GBuffer"].drawn == 3
    assert rows["UploadMeshes"].drawn == rows["SamplePoints"].drawn == rows["SelectPoints"].drawn == 1


def test_every_sample_has_its_own_rays(device, scene_and_view):
    rows = draw(device, *scene_and_view, with_quality(SETTINGS, samples=3)).profile.rows
    assert rows["SelectTiles"].drawn == rows["GBuffer"].drawn == rows["TraceShadows"].drawn == 3
    assert (
        rows["UploadMeshes"].drawn
        == rows["BuildBLAS"].drawn
        == rows["BuildTLAS"].drawn
        == rows["ProbeVisibility"].drawn
        == 1
    )


def test_two_renders_are_bit_identical(device, scene_and_view, base):
    settings = with_quality(base, samples=6)
    one, two = (draw(device, *scene_and_view, settings).color for _ in range(2))
    assert np.array_equal(one, two)


def test_an_interrupted_picture_leaves_no_trace(device, scene_and_view, base):
    """A request that was dropped in the middle of a sample, and another one drawn after it."""
    from ism_addon.gpu.profile import Profile

    scene, view = scene_and_view
    settings = with_quality(base, samples=2)
    whole = draw(device, scene, view, settings)
    expected = whole.color
    other = replace(scene, lights=replace(scene.lights, position=scene.lights.position + 0.3))
    for steps in range(1, len(whole.profile.rows), 2):
        drawing = whole.renderer.sample(other, view, settings, 0, Profile())
        for _ in range(steps):
            next(drawing)
        drawing.close()
        assert np.array_equal(draw(device, scene, view, settings, whole.renderer).color, expected), steps


@pytest.mark.parametrize("target", DebugView)
def test_every_target_can_be_shown(device, scene_and_view, base, target):
    shown = draw(device, *scene_and_view, replace(base, debug_view=target)).color
    assert shown.shape == (16, 24, 4)
    assert np.isfinite(shown).all()


@pytest.mark.parametrize("off", ["ssao", "shadow"])
def test_targets_that_nobody_drew_can_be_shown(device, scene_and_view, base, off):
    settings = replace(base, **{off: replace(getattr(base, off), enabled=False)})
    for target in DebugView:
        assert np.isfinite(draw(device, *scene_and_view, replace(settings, debug_view=target)).color).all()
