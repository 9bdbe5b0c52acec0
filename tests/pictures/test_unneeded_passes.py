# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes that a picture does not need are not drawn, and tiny neutral textures replace their targets."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ism_addon.gpu import renderer
from ism_addon.gpu.gl import driver_variants
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.gl.frame_uniforms import clip_from_anchor
from ism_addon.gpu.passes.occlusion.ambient_occlusion import projected_radius
from ism_addon.resources import MATERIAL_BUFFERS
from ism_addon.scene import World
from ism_addon.settings import SSAO, Method
from tests.scenes.changes import WITHOUT_LIGHT, WITHOUT_OCCLUSION, WITHOUT_SHADOWS, with_ssao
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    first_frame,
    look_at,
    make_scene,
    quad,
    random_triangles,
    view_from_above,
    with_quality,
)

SETTINGS = {
    Method.RAY_TRACED: replace(SMALL_SETTINGS, ssao=SSAO()),
    Method.SHADOW_MAPS: replace(SMALL_SHADOW_MAPS, ssao=SSAO()),
}
SIZE = 64, 48

RAY_PASSES = {"BuildBLAS", "UploadBLAS", "BuildTLAS", "ProbeVisibility", "RetestOccluded"}
LIGHT_PASSES = {"UploadLights", "CullLights"}
RAY_TRACED_LIGHT_PASSES = {"PredictVisibility", "MatchPredictions", "SelectFaintLights", "TraceShadows"}
SHADOW_MAPPED_LIGHT_PASSES = {"PlaceVirtualLights", "GatherLight"}
SHADOW_MAP_PASSES = {"SamplePoints", "WeighLights", "SelectPoints", "SplatMaps", "FillHoles"}
OCCLUSION_PASSES = {"AmbientOcclusion", "BlurOcclusion"}

#: Passes that only the other method draws.
OTHER_METHOD_PASSES = {
    Method.RAY_TRACED: SHADOW_MAPPED_LIGHT_PASSES | SHADOW_MAP_PASSES,
    Method.SHADOW_MAPS: RAY_PASSES | RAY_TRACED_LIGHT_PASSES,
}
#: Passes that lights need, and those that shadows need.
PASSES_FOR_LIGHTS = {
    Method.RAY_TRACED: LIGHT_PASSES | RAY_PASSES | RAY_TRACED_LIGHT_PASSES,
    Method.SHADOW_MAPS: LIGHT_PASSES | SHADOW_MAP_PASSES | SHADOW_MAPPED_LIGHT_PASSES,
}
PASSES_FOR_SHADOWS = {
    Method.RAY_TRACED: RAY_PASSES | {"PredictVisibility", "MatchPredictions"},
    Method.SHADOW_MAPS: SHADOW_MAP_PASSES,
}

#: Changes of a scene and its settings, and the passes that each makes unnecessary.
UNNEEDED_PASSES = {
    **dict.fromkeys(WITHOUT_LIGHT, PASSES_FOR_LIGHTS),
    **dict.fromkeys(WITHOUT_SHADOWS, PASSES_FOR_SHADOWS),
    **dict.fromkeys(WITHOUT_OCCLUSION, dict.fromkeys(Method, OCCLUSION_PASSES)),
}


def lit_scene():
    """A box over a plane under a light and a bright world, in view of the camera."""
    scene, view = box_over_plane(*SIZE)
    return replace(scene, world=World.even(np.full(3, 0.5, np.float32))), view


@pytest.mark.parametrize("method", Method, ids=[method.label for method in Method])
@pytest.mark.parametrize("change", UNNEEDED_PASSES)
def test_unneeded_passes_are_skipped(device, change, method):
    scene, view = lit_scene()
    all_settings = with_quality(SETTINGS[method], samples=2)
    changed_scene, changed_settings = change(scene, all_settings)
    complete, reduced = draw(device, scene, view, all_settings), draw(device, changed_scene, view, changed_settings)
    drawn = {name for name, row in reduced.profile.rows.items() if row.drawn}
    skipped = UNNEEDED_PASSES[change][method]
    assert drawn == {name for name, row in complete.profile.rows.items() if row.drawn} - skipped
    assert not drawn & OTHER_METHOD_PASSES[method]
    outputs = {target for pass_type in renderer.PASSES if pass_type.__name__ in skipped for target in pass_type.outputs}
    skipped_targets = {each for each in outputs if each in complete.renderer.graph.targets.textures}
    reduced_textures = reduced.renderer.graph.targets.textures
    assert {reduced_textures[target].size for target in skipped_targets & reduced_textures.keys()} <= {
        driver_variants.sides((1, 1))
    }
    complete_bytes, reduced_bytes = (
        sum(texture_bytes(textures[target]) for target in skipped_targets & textures.keys())
        for textures in (each.renderer.graph.targets.textures for each in (complete, reduced))
    )
    target_bytes = (each.profile.counts["render_target_bytes"] for each in (complete, reduced))
    assert reduced_bytes <= 9 * 16 * len(skipped_targets) < complete_bytes
    assert next(target_bytes) - next(target_bytes) >= complete_bytes - reduced_bytes


def texture_bytes(texture) -> int:
    return texture.width * texture.height * texture.components * int(texture.dtype[1:])


def test_without_images_there_are_no_texels_and_no_textured_shader(device):
    scene, view = lit_scene()
    assert not scene.images
    before = set(device.programs)
    drawn = draw(device, scene, view, SETTINGS[Method.RAY_TRACED])
    assert not drawn.renderer.graph[MATERIAL_BUFFERS].texels.textures
    assert not [key for key in device.programs.keys() - before if ("images", 1) in key[-1]]


@pytest.mark.parametrize("field_of_view", [0.1, 1.0, 2.5])
@pytest.mark.parametrize("camera_y", [None, -6.0, 6.0])
def test_projected_radius_bounds_the_projections_of_nearby_points(device, camera_y, field_of_view):
    generator, radius = np.random.default_rng(5), 0.2
    view = (
        look_at((0.0, camera_y, 1.0), (0.2, 0.0, 0.0), SIZE, field_of_view) if camera_y else view_from_above(2.0, SIZE)
    )
    scene = make_scene([random_triangles()])
    prepared_renderer, _ = first_frame(device, scene)
    drawn = draw(device, scene, view, renderer=prepared_renderer)
    frame = prepared_renderer.last[0]
    points = drawn.target("position")[drawn.target("position")[..., 3] != 0.0][:, :3]
    assert len(points) > 10
    offsets = generator.normal(size=(200, 1, 3))
    offsets *= radius / np.linalg.norm(offsets, axis=2, keepdims=True)
    clip = clip_from_anchor(view, frame.anchor)
    before, after = (projected(clip, p) for p in (points[None], points[None] + offsets))
    farthest = (np.abs(after - before) * SIZE).max() / 2.0
    bound = projected_radius(frame, radius)
    assert 0.2 * bound < farthest <= bound


def projected(clip, points):
    """(…,2): normalised device coordinates of points (…,3)."""
    homogeneous = points @ clip[:, :3].T + clip[:, 3]
    return homogeneous[..., :2] / homogeneous[..., 3:]


def test_projected_radius_is_infinite_if_the_camera_may_be_near_a_surface(device):
    room = make_scene([quad((-4.0, -4.0, 0.0), (8.0, 0.0, 0.0), (0.0, 8.0, 0.0))])
    frame, _ = draw(device, room, look_at((0.0, 0.0, 1.0), (0.0, 3.0, 0.0))).renderer.last
    assert projected_radius(frame, 1e-3) == np.inf


@pytest.mark.parametrize(("radius", "drawn"), [(0.03, 0), (0.07, 1)])
def test_an_occlusion_radius_below_half_a_pixel_is_not_drawn(device, radius, drawn):
    """The view is from above; a pixel is 1/8 m wide."""
    scene, _ = lit_scene()
    settings = with_ssao(SETTINGS[Method.RAY_TRACED], radius=radius)
    rows = draw(device, scene, view_from_above(8.0, (64, 64)), settings).profile.rows
    assert {rows[name].drawn for name in OCCLUSION_PASSES} == {drawn}


def test_skipped_occlusion_would_have_changed_nothing(device):
    scene, view = lit_scene()
    settings = with_ssao(SETTINGS[Method.RAY_TRACED], radius=1e-3)
    skipped = draw(device, scene, view, settings)
    assert not skipped.profile.rows["AmbientOcclusion"].drawn
    drawn = draw(device, scene, view, replace(settings, shortcuts=False))
    assert drawn.profile.rows["AmbientOcclusion"].drawn
    assert (drawn.target("raw_occlusion") == 1.0).all()
    assert (drawn.target("ambient_occlusion") == 1.0).all()


#: Shaders of one sample without lights, and those added by lights, by shadows and by further samples.
UNLIT_FILES = {"visibility_buffer.frag", "gbuffer.frag", "shade.frag", "accumulate.frag", "resolve.frag"}
LIT_FILES = {"cull_lights.frag", "trace_shadows.frag"}
SHADOW_FILES = {
    "probe_rays.frag",
    *(f"predict_visibility{suffix}.frag" for suffix in ("", "_tiles", "_probes")),
}
FURTHER_FILES = {"match_predictions.frag", "resolve_neighbours.frag", "select_tiles.frag", "estimate_error.frag"}


@pytest.mark.parametrize(
    ("change", "samples", "files"),
    [
        (WITHOUT_LIGHT[0], 1, UNLIT_FILES),
        (WITHOUT_SHADOWS[0], 1, UNLIT_FILES | LIT_FILES),
        (WITHOUT_OCCLUSION[0], 1, UNLIT_FILES | LIT_FILES | SHADOW_FILES),
        (WITHOUT_OCCLUSION[0], 2, UNLIT_FILES | LIT_FILES | SHADOW_FILES | FURTHER_FILES),
    ],
    ids=["unlit", "without shadows", "one sample", "two samples"],
)
def test_programs_of_unneeded_passes_are_not_linked(change, samples, files):
    device, (scene, view) = open_device(), lit_scene()
    scene, settings = change(scene, with_quality(SMALL_SETTINGS, samples=samples))
    draw(device, scene, view, settings)
    linked = {Path(name).name for names, *_ in device.programs for name in names if name.endswith(".frag")}
    device.close()
    assert linked == files
