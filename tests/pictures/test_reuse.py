# SPDX-License-Identifier: GPL-3.0-or-later
"""Which passes a changed setting draws again; the same request gives the same picture. See also test_edits."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu import renderer
from ism_addon.gpu.estimators import RayTracedDirect, ShadowMappedDirect
from ism_addon.resources import INSTANCE_BUFFERS, MATERIAL_BUFFERS, MESH_BUFFERS
from ism_addon.scene import Image, World
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
SHADOW_MAP_SETTINGS = replace(SMALL_SHADOW_MAPS, ssao=SSAO())
METHODS = {method.label: settings for method, settings in zip(Method, (SETTINGS, SHADOW_MAP_SETTINGS), strict=True)}
BVH_PASSES = {"BuildBLAS", "UploadBLAS", "BuildTLAS"}
PHASES = *renderer.UPLOAD, *renderer.SURFACES, *renderer.SELECTION
COMMON_PASSES = (
    {pass_type.__name__ for pass_type in PHASES}
    - BVH_PASSES
    - {*("UploadUVs", "UploadAttributes", "UploadPointGraphs", "TransmittedColor", "FindGraphs", "CacheIrradiance")}
)
#: There is nothing to retest, predictions are its own, and no world that may need portals.
NOT_IN_FIRST_SAMPLE = {"RetestOccluded", "MatchPredictions", "FindPortals"}
DIRECT_LIGHT_PASSES = {pass_type.__name__ for pass_type in RayTracedDirect.pass_types} - NOT_IN_FIRST_SAMPLE
RAY_PASSES = BVH_PASSES | DIRECT_LIGHT_PASSES
ATLAS_PASSES = {pass_type.__name__ for pass_type in ShadowMappedDirect.FOR_EACH_ATLAS}
SHADOW_MAP_PASSES = {pass_type.__name__ for pass_type in ShadowMappedDirect.pass_types}
OCCLUSION_PASSES = {"AmbientOcclusion", "BlurOcclusion"}
FILM_PASSES = {"Shade", "Accumulate", "Resolve", "EstimateError"}


@pytest.fixture
def scene_and_view():
    return box_over_plane(24, 16)


@pytest.fixture(params=METHODS)
def base(request):
    """The settings of one method."""
    return METHODS[request.param]


@pytest.fixture
def again(device, scene_and_view):
    """again(before, scene, view, after): the names of the passes that a second picture draws after a first one."""
    scene, view = scene_and_view

    def passes(before=SETTINGS, scene=scene, view=view, after=None) -> set[str]:
        first = draw(device, *scene_and_view, before)
        assert first.color.any()
        second = draw(device, scene, view, after or before, first.renderer)
        fresh = draw(device, scene, view, after or before)
        assert np.array_equal(second.color, fresh.color), "a reused result was out of date"
        return {name for name, row in second.profile.rows.items() if row.drawn}

    return passes


@pytest.mark.parametrize(
    ("settings", "expected"), [(SETTINGS, RAY_PASSES), (SHADOW_MAP_SETTINGS, SHADOW_MAP_PASSES)], ids=METHODS
)
def test_the_first_picture_draws_the_passes_of_its_method(device, scene_and_view, settings, expected):
    drawn = draw(device, *scene_and_view, settings)
    assert drawn.color.any()
    passes = {name for name, row in drawn.profile.rows.items() if row.drawn}
    assert passes == COMMON_PASSES | expected | OCCLUSION_PASSES | FILM_PASSES
    assert drawn.profile.counts["virtual_lights"] == (8 if settings == SHADOW_MAP_SETTINGS else 0)
    assert drawn.profile.counts["bytes_uploaded"] > 0


def test_renderers_share_the_buffers_of_a_scene(device, scene_and_view):
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
    assert again(base, replace(scene, world=World.even(np.full(3, 0.4, np.float32)))) == FILM_PASSES


def test_the_other_method_keeps_uploaded_data(again):
    assert again(SETTINGS, after=SHADOW_MAP_SETTINGS) >= SHADOW_MAP_PASSES | {"SelectTiles", "Shade", "Accumulate"}
    assert again(SHADOW_MAP_SETTINGS, after=SETTINGS) >= RAY_PASSES | {"SelectTiles", "Shade", "Accumulate"}
    assert not again(SETTINGS, after=SHADOW_MAP_SETTINGS) & {"UploadMeshes", "UploadInstances", "UploadMaterials"}
    assert "UploadMaterials" not in again(SHADOW_MAP_SETTINGS, after=SETTINGS), (
        "rays need another order of the triangles, but no other materials"
    )


@pytest.mark.parametrize(
    ("section", "changes", "by_rays", "by_maps"),
    [
        ("ssao", {"radius": 0.2}, OCCLUSION_PASSES | FILM_PASSES, OCCLUSION_PASSES | FILM_PASSES),
        ("ssao", {"intensity": 2.0}, OCCLUSION_PASSES | FILM_PASSES, OCCLUSION_PASSES | FILM_PASSES),
        ("ssao", {"enabled": False}, {"CullMeshes"} | FILM_PASSES, {"CullMeshes"} | FILM_PASSES),
        ("shadow", {"bias": 2.0}, set(), {"GatherLight"} | FILM_PASSES),
        ("shadow", {"fill_threshold": 0.1}, set(), {"FillHoles", "GatherLight"} | FILM_PASSES),
        ("shadow", {"fill_holes": False}, set(), {"GatherLight"} | FILM_PASSES),
        ("shadow", {"splat_size": 2.0}, set(), {"SelectPoints"} | ATLAS_PASSES | FILM_PASSES),
        (
            "shadow",
            {"enabled": False},
            {"CullMeshes", "CullLights", "SelectFaintLights", "TraceShadows"} | FILM_PASSES,
            {"CullMeshes", "PlaceVirtualLights", "GatherLight"} | FILM_PASSES,
        ),
        ("quality", {"map_size": 64}, set(), ATLAS_PASSES | FILM_PASSES),
        ("quality", {"map_points": 1000}, set(), SHADOW_MAP_PASSES | FILM_PASSES),
        ("quality", {"virtual_lights": 5}, set(), {"PlaceVirtualLights"} | ATLAS_PASSES | FILM_PASSES),
    ],
)
def test_a_setting_redraws_its_own_passes(again, section, changes, by_rays, by_maps):
    for before, expected in ((SETTINGS, by_rays), (SHADOW_MAP_SETTINGS, by_maps)):
        after = replace(before, **{section: replace(getattr(before, section), **changes)})
        assert again(before, after=after) == expected


def test_switched_on_again_after_it_was_off(device, scene_and_view, base):
    """A pass that was skipped must not count as up to date."""
    scene, view = scene_and_view
    first = draw(device, scene, view, base)
    before = first.color
    disabled = replace(base, ssao=replace(base.ssao, enabled=False), shadow=replace(base.shadow, enabled=False))
    assert not np.array_equal(draw(device, scene, view, disabled, first.renderer).color, before)
    assert np.array_equal(draw(device, scene, view, base, first.renderer).color, before)


def test_another_size_of_picture(device, scene_and_view, base):
    scene, view = scene_and_view
    first = draw(device, scene, view, base)
    larger = replace(view, width=40, height=30)
    second = draw(device, scene, larger, base, first.renderer)
    assert np.array_equal(second.color, draw(device, scene, larger, base).color)
    assert second.profile.rows["SplatMaps"].drawn == second.profile.rows["BuildTLAS"].drawn == 0


def test_every_sample_has_its_own_virtual_lights(device, scene_and_view):
    rows = draw(device, *scene_and_view, with_quality(SHADOW_MAP_SETTINGS, samples=3)).profile.rows
    assert rows["PlaceVirtualLights"].drawn == rows["SplatMaps"].drawn == rows["GBuffer"].drawn == 3
    assert rows["UploadMeshes"].drawn == rows["SamplePoints"].drawn == rows["SelectPoints"].drawn == 1


def test_every_sample_has_its_own_rays(device, scene_and_view):
    """The first sample is drawn without rays, then shaded again."""
    rows = draw(device, *scene_and_view, with_quality(SETTINGS, samples=3)).profile.rows
    assert rows["GBuffer"].drawn == 3
    assert rows["SelectTiles"].drawn == rows["TraceShadows"].drawn == 4
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
    """A request is dropped in the middle of a sample, and another one is drawn after it."""
    from ism_addon.gpu.profile import Profile

    scene, view = scene_and_view
    settings = with_quality(base, samples=2)
    complete = draw(device, scene, view, settings)
    expected = complete.color
    other = replace(scene, lights=replace(scene.lights, position=scene.lights.position + 0.3))
    for pass_count in range(1, len(complete.profile.rows), 2):
        drawing = complete.renderer.sample(other, view, settings, 0, Profile())
        for _ in range(pass_count):
            next(drawing)
        drawing.close()
        assert np.array_equal(draw(device, scene, view, settings, complete.renderer).color, expected), pass_count


@pytest.mark.parametrize("target", DebugView)
def test_every_target_can_be_shown(device, scene_and_view, base, target):
    shown = draw(device, *scene_and_view, replace(base, debug_view=target)).color
    assert shown.shape == (16, 24, 4)
    assert np.isfinite(shown).all()


@pytest.mark.parametrize("disabled", ["ssao", "shadow"])
def test_targets_of_skipped_passes_can_be_shown(device, scene_and_view, base, disabled):
    settings = replace(base, **{disabled: replace(getattr(base, disabled), enabled=False)})
    for target in DebugView:
        assert np.isfinite(draw(device, *scene_and_view, replace(settings, debug_view=target)).color).all()
