# SPDX-License-Identifier: GPL-3.0-or-later
"""What a picture does not need is not drawn, and takes no memory: a few neutral texels stand for it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ism_addon.gpu import renderer
from ism_addon.gpu.gl import driver_variants
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.gl.frame_uniforms import clip_from_anchor
from ism_addon.gpu.passes.environment.ambient_occlusion import projected_radius
from ism_addon.resources import MATERIAL_BUFFERS
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

RAYS = {"BuildBLAS", "UploadBLAS", "BuildTLAS", "ProbeVisibility", "RetestOccluded"}
LIGHTS = {"UploadLights", "CullLights"}
LIGHT_BY_RAYS = {"PredictVisibility", "SelectFaintLights", "TraceShadows"}
LIGHT_BY_MAPS = {"PlaceVirtualLights", "GatherLight"}
MAPS_ALONE = {"SamplePoints", "WeighLights", "SelectPoints", "SplatMaps", "FillHoles"}
OCCLUSION = {"AmbientOcclusion", "BlurOcclusion"}

#: What only the other method draws.
OTHERS = {
    Method.RAY_TRACED: LIGHT_BY_MAPS | MAPS_ALONE,
    Method.SHADOW_MAPS: RAYS | LIGHT_BY_RAYS,
}
LIT = {Method.RAY_TRACED: LIGHTS | RAYS | LIGHT_BY_RAYS, Method.SHADOW_MAPS: LIGHTS | MAPS_ALONE | LIGHT_BY_MAPS}
SHADOWED = {Method.RAY_TRACED: RAYS | {"PredictVisibility"}, Method.SHADOW_MAPS: MAPS_ALONE}


WITHOUT = {
    **dict.fromkeys(WITHOUT_LIGHT, LIT),
    **dict.fromkeys(WITHOUT_SHADOWS, SHADOWED),
    **dict.fromkeys(WITHOUT_OCCLUSION, dict.fromkeys(Method, OCCLUSION)),
}


def lit_stage():
    """A box over a plane under a lamp, all of it before the camera."""
    scene, view = box_over_plane(*SIZE)
    return replace(scene, world=replace(scene.world, radiance=np.full(3, 0.5, np.float32))), view


@pytest.mark.parametrize("method", Method, ids=[method.label for method in Method])
@pytest.mark.parametrize("why", WITHOUT)
def test_what_is_not_needed_is_left_out(device, why, method):
    scene, view = lit_stage()
    with_all = with_quality(SETTINGS[method], samples=2)
    scene_without, without = why(scene, with_all)
    whole, part = draw(device, scene, view, with_all), draw(device, scene_without, view, without)
    drawn = {name for name, row in part.profile.rows.items() if row.drawn}
    left_out = WITHOUT[why][method]
    assert drawn == {name for name, row in whole.profile.rows.items() if row.drawn} - left_out
    assert not drawn & OTHERS[method]
    outputs = {target for kind in renderer.PASSES if kind.__name__ in left_out for target in kind.outputs}
    spared = {each for each in outputs if each in whole.renderer.graph.targets.textures}
    neutral = part.renderer.graph.targets.textures
    assert {neutral[target].size for target in spared & neutral.keys()} <= {driver_variants.sides((1, 1))}
    taken, left = (
        sum(memory_of(textures[target]) for target in spared & textures.keys())
        for textures in (each.renderer.graph.targets.textures for each in (whole, part))
    )
    counted = (each.profile.counts["render_target_bytes"] for each in (whole, part))
    assert left <= 9 * 16 * len(spared) < taken
    assert next(counted) - next(counted) >= taken - left


def memory_of(texture) -> int:
    return texture.width * texture.height * texture.components * int(texture.dtype[1:])


def test_without_images_no_texel_and_no_shader_for_them(device):
    scene, view = lit_stage()
    assert not scene.images
    before = set(device.programs)
    drawn = draw(device, scene, view, SETTINGS[Method.RAY_TRACED])
    assert not drawn.renderer.graph[MATERIAL_BUFFERS].texels.textures
    assert not [key for key in device.programs.keys() - before if ("images", 1) in key[-1]]


@pytest.mark.parametrize("across", [0.1, 1.0, 2.5])
@pytest.mark.parametrize("away", [None, -6.0, 6.0])
def test_no_point_about_what_is_seen_is_farther_on_the_screen_than_is_said(device, away, across):
    generator, radius = np.random.default_rng(5), 0.2
    view = look_at((0.0, away, 1.0), (0.2, 0.0, 0.0), SIZE, across) if away else view_from_above(2.0, SIZE)
    scene = make_scene([random_triangles()])
    prepared_renderer, _ = first_frame(device, scene)
    drawn = draw(device, scene, view, renderer=prepared_renderer)
    frame = prepared_renderer.last[0]
    points = drawn.target("position")[drawn.target("position")[..., 3] != 0.0][:, :3]
    assert len(points) > 10
    around = generator.normal(size=(200, 1, 3))
    around *= radius / np.linalg.norm(around, axis=2, keepdims=True)
    clip = clip_from_anchor(view, frame.anchor)
    before, after = (on_screen(clip, p) for p in (points[None], points[None] + around))
    farthest = (np.abs(after - before) * SIZE).max() / 2.0
    said = projected_radius(frame, radius)
    assert 0.2 * said < farthest <= said


def on_screen(clip, points):
    """(…,2): from -1 to 1 in the picture."""
    homogeneous = points @ clip[:, :3].T + clip[:, 3]
    return homogeneous[..., :2] / homogeneous[..., 3:]


def test_what_the_camera_may_be_in_the_middle_of_is_any_distance_away(device):
    room = make_scene([quad((-4.0, -4.0, 0.0), (8.0, 0.0, 0.0), (0.0, 8.0, 0.0))])
    frame, _ = draw(device, room, look_at((0.0, 0.0, 1.0), (0.0, 3.0, 0.0))).renderer.last
    assert projected_radius(frame, 1e-3) == np.inf


@pytest.mark.parametrize(("radius", "drawn"), [(0.03, 0), (0.07, 1)])
def test_a_radius_of_less_than_half_a_pixel_is_too_small(device, radius, drawn):
    """In a view from above whose pixels are an eighth of a metre wide."""
    scene, _ = lit_stage()
    settings = with_ssao(SETTINGS[Method.RAY_TRACED], radius=radius)
    rows = draw(device, scene, view_from_above(8.0, (64, 64)), settings).profile.rows
    assert {rows[name].drawn for name in OCCLUSION} == {drawn}


def test_where_occlusion_is_left_out_it_would_have_changed_nothing(device):
    scene, view = lit_stage()
    settings = with_ssao(SETTINGS[Method.RAY_TRACED], radius=1e-3)
    left_out = draw(device, scene, view, settings)
    assert not left_out.profile.rows["AmbientOcclusion"].drawn
    drawn = draw(device, scene, view, replace(settings, shortcuts=False))
    assert drawn.profile.rows["AmbientOcclusion"].drawn
    assert (drawn.target("raw_occlusion") == 1.0).all()
    assert (drawn.target("ambient_occlusion") == 1.0).all()


#: Shaders of one sample without lights; what lights add to it, shadows to that, and what further samples do.
UNLIT = {"visibility_buffer.frag", "gbuffer.frag", "shade.frag", "accumulate.frag", "resolve.frag"}
LIT_FILES = {"cull_lights.frag", "trace_shadows.frag"}
SHADOW_FILES = {
    "probe_rays.frag",
    *(f"predict_visibility{part}.frag" for part in ("", "_tiles", "_probes")),
}
FURTHER_FILES = {"resolve_neighbours.frag", "select_tiles.frag", "estimate_error.frag"}


@pytest.mark.parametrize(
    ("why", "samples", "files"),
    [
        (WITHOUT_LIGHT[0], 1, UNLIT),
        (WITHOUT_SHADOWS[0], 1, UNLIT | LIT_FILES),
        (WITHOUT_OCCLUSION[0], 1, UNLIT | LIT_FILES | SHADOW_FILES),
        (WITHOUT_OCCLUSION[0], 2, UNLIT | LIT_FILES | SHADOW_FILES | FURTHER_FILES),
    ],
    ids=["unlit", "without shadows", "one sample", "two samples"],
)
def test_programs_of_passes_that_are_not_needed_are_not_linked(why, samples, files):
    device, (scene, view) = open_device(), lit_stage()
    scene, settings = why(scene, with_quality(SMALL_SETTINGS, samples=samples))
    draw(device, scene, view, settings)
    linked = {Path(name).name for names, *_ in device.programs for name in names if name.endswith(".frag")}
    device.close()
    assert linked == files
