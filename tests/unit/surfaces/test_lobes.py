# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes of microfacets in GLSL against a model in float64, and pictures against sums over a light's points."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.scene import LightShape
from ism_addon.settings import Shadow
from ism_addon.shading.builder import Builder, constant
from tests.scenes.parts.tables import materials_of
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    draw,
    join_lights,
    light,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)
from tests.tables import ggx, lookup
from tests.unit.shading import glsl_functions

COUNT = 500
FILE = "materials/gloss.glsl"
#: A dielectric's lobe of operands: roughness, index of refraction, directions to the camera and to the light.
LOBE = (
    "Gloss(vec3(dielectric_f0(a1)), vec3(0.0), vec3(1.0 - dielectric_f0(a1)), vec3(0.0), a1, a0, 1.0, 0.0, vec4(0.0))"
)
FACETS = f"microfacets({LOBE}, vec3(0.0, 0.0, 1.0))"


@pytest.fixture
def operands():
    """(N,) roughness and index of refraction, (N,3) two directions in the upper hemisphere."""
    random = np.random.default_rng(3)
    directions = random.normal(size=(2, COUNT, 3))
    directions[..., 2] = np.abs(directions[..., 2]) + 0.01
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    return [random.uniform(0.1, 1.0, COUNT), random.uniform(1.2, 2.5, COUNT), *directions]


def test_the_value_and_the_density_of_a_lobe(device, operands):
    roughness, eta, wo, wi = operands
    value = f"evaluate_gloss({LOBE}, {FACETS}, a2, a3)"
    result = glsl_functions.evaluate(device, FILE, f"vec2({value}.reflected.r, {value}.pdf)", operands)
    alpha, half_way = roughness**2, ggx.half_vector(wo, wi)
    expected = ggx.evaluate(wo, wi, alpha) * ggx.fresnel_dielectric((half_way * wi).sum(-1), eta)
    assert np.allclose(result[:, 0], expected, rtol=1e-3, atol=1e-6)
    assert np.allclose(result[:, 1], ggx.density(wo, wi, alpha), rtol=1e-3, atol=1e-6)


def test_samples_are_visible_normals(device, operands):
    roughness, eta, wo, _ = operands
    uv = np.random.default_rng(4).random((COUNT, 2))
    result = glsl_functions.evaluate(device, FILE, f"sample_visible_normal({FACETS}, a2, a3)", [roughness, eta, wo, uv])
    # The basis about z is the identity, so the same numbers give the same normals.
    expected = ggx.sample_visible_normal(wo, roughness**2, *uv.T)
    assert np.abs(result[:, :3] - expected).max() < 2e-4


def test_lobes_are_packed(device, operands):
    roughness, eta, *_ = operands
    reflectances = np.random.default_rng(5).uniform(0.0, 3.9, (COUNT, 3))
    lobe = "Gloss(a2, 0.5 * a2, 0.25 * a2, 0.5 * a2, a1, a0, 0.5, 0.25, vec4(1.0, -1.0, 0.5, 2.0))"
    unpacked = f"unpack_gloss(pack_reflectance({lobe}), pack_rise({lobe}, 1048575u), pack_ltc({lobe}.ltc))"
    for member, expected, error in (
        ("f0", reflectances, 1e-4),
        ("schlick", 0.5 * reflectances, 1e-4),
        ("dielectric", 0.25 * reflectances, 1e-4),
        ("edge", 0.5 * reflectances, 17.0 * 5e-4),  # it changes the reflectance by a 17th at most
        ("mean_rise", np.full((COUNT, 1), 0.25), 1e-4),
        ("eta", eta[:, None], 1e-3),
        ("roughness", roughness[:, None], 1e-4),
        ("ltc", np.tile([1.0, -1.0, 0.5, 2.0], (COUNT, 1)), 1e-4),
    ):
        result = glsl_functions.evaluate(device, FILE, f"{unpacked}.{member}", [roughness, eta, reflectances])
        assert np.abs(result[:, : expected.shape[1]] - expected).max() < error, member


def test_normals_without_bumps_are_packed(device, operands):
    """With other members of the same bits; 0 stands for none."""
    *_, normals = operands
    lobe = "Gloss(vec3(0.5), vec3(0.5), vec3(0.5), vec3(3.9), 1.5, 0.5, 0.5, 1.0, vec4(0.0))"
    other = "vec3(1.0, 2.0, 3.0)"
    for bumps, expected, error in (("pack_smooth_normal(a0)", normals, 4e-3), ("0u", [1.0, 2.0, 3.0], 0.0)):
        expression = f"unpack_smooth_normal(pack_rise({lobe}, {bumps}), {other})"
        result = glsl_functions.evaluate(device, FILE, expression, [normals])
        assert np.linalg.norm(result[:, :3] - expected, axis=1).max() <= error


def metal(roughness):
    """A graph of a metal lobe that reflects light between microfacets once, and its constants."""
    builder = Builder()
    white, normal = constant((1.0, 1.0, 1.0)), builder.call("geometry_normal")
    operands = white, constant((0.9, 0.5, 0.2)), white, constant(roughness), normal
    return builder.finish([builder.call("closure_metal", *operands, parameter=0)])


def floor_of(graph, constants, lights=None):
    """A square of a graph's material under lights."""
    materials = replace(
        materials_of([(0.5, 0.5, 0.5)]),
        graph=np.zeros(1, np.int32),
        first_constant=np.zeros(1, np.int32),
        constants=constants,
    )
    floor = quad((-1.0, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    return replace(make_scene([floor], lights), materials=materials, graphs=(graph,))


@pytest.mark.parametrize("shape", [LightShape.RECTANGLE, LightShape.ELLIPSE])
@pytest.mark.parametrize("roughness", [0.15, 0.4, 0.9])
def test_a_metal_reflects_all_points_of_a_light(device, roughness, shape):
    axis_u, axis_v, height = (1.2, 0.0, 0.0), (0.0, -0.8, 0.0), 1.5
    lights = light(shape, (0.3, 0.2, height), axis_u, axis_v, radiance=2.0)
    graph, constants = metal(roughness)
    view = view_from_above(2.0, (16, 16))
    drawn = draw(device, floor_of(graph, constants, lights), view, with_quality(SMALL_SETTINGS, samples=256))
    x, y = np.meshgrid((np.arange(16) + 0.5) / 8.0 - 1.0, (np.arange(16) + 0.5) / 8.0 - 1.0)
    p = np.stack([x, y, np.zeros_like(x)], -1)[..., None, :]
    u = (np.arange(256) + 0.5) / 256.0 - 0.5
    points = np.array([0.3, 0.2, height]) + np.stack(
        [1.2 * u.repeat(256), 0.8 * np.tile(u, 256), 0.0 * np.tile(u, 256)], -1
    )
    if shape == LightShape.ELLIPSE:
        points = points[(u.repeat(256) ** 2 + np.tile(u, 256) ** 2) <= 0.25]
    to = points - p
    square = (to * to).sum(-1)
    wi, wo = to / np.sqrt(square)[..., None], np.broadcast_to([0.0, 0.0, 1.0], to.shape)
    cosine = (ggx.half_vector(wo, wi) * wi).sum(-1)
    value = ggx.evaluate(wo, wi, roughness**2) * wi[..., 2] / square * (1.2 * 0.8 / 256**2)
    f0 = np.array([0.9, 0.5, 0.2])
    rise = ((1.0 - cosine) ** 5 * value).sum(-1)[..., None]
    expected = 2.0 * (f0 * value.sum(-1)[..., None] + (1.0 - f0) * rise)
    error = drawn.color[..., :3] - expected
    assert np.sqrt((error**2).mean()) < 0.01 * expected.mean()
    assert abs(error.mean()) < 0.002 * expected.mean()


@pytest.mark.parametrize(("roughness", "is_reflected"), [(0.0, False), (0.02, True)])
def test_mirrors_do_not_show_lights_without_a_size(device, roughness, is_reflected):
    graph, constants = metal(roughness)
    lamp = light(LightShape.POINT, (0.1, 0.1, 20.0), radiance=100.0, radius=0.0)
    drawn = draw(device, floor_of(graph, constants, lamp), view_from_above(2.0, (32, 32)))
    assert drawn.color[..., :3].any() == is_reflected


def test_reflections_of_emissive_meshes_are_not_occluded_by_them(device):
    """A smooth metal below a ceiling; both emit, and the camera between them sees what the metal emits and reflects."""
    graph, constants = metal(0.05)
    scene = floor_of(graph, constants, None)
    ceiling = quad((-30.0, -30.0, 11.3), (60.0, 0.0, 0.0), (0.0, 60.0, 0.0))
    materials = replace(scene.materials, emission=np.ones((1, 3), np.float32))
    scene = replace(make_scene([scene.meshes[0], ceiling]), materials=materials, graphs=scene.graphs)
    drawn = draw(device, scene, view_from_above(2.0, (16, 16)), with_quality(SMALL_SETTINGS, samples=64))
    reflected = drawn.color[2:-2, 2:-2, :3].mean((0, 1)) - 1.0
    assert np.allclose(reflected, [0.9, 0.5, 0.2], rtol=0.02)


@pytest.mark.parametrize("shape", [LightShape.RECTANGLE, LightShape.ELLIPSE])
def test_no_light_is_reflected_behind_an_area(device, shape):
    """The surface is close to the light, on the side that does not emit."""
    above = light(shape, (0.0, 0.0, 0.02), (0.8, 0.0, 0.0), (0.0, 0.8, 0.0), radiance=100.0)
    assert above.normal[0, 2] > 0.0
    settings = with_quality(SMALL_SETTINGS, samples=8)
    drawn = draw(device, floor_of(*metal(0.9), above), view_from_above(2.0, (16, 16)), settings)
    assert not drawn.color[..., :3].any()


def test_a_light_of_negligible_irradiance_is_reflected(device):
    """Its radiance is a hundred times that of the other light, its irradiance less than a thousandth."""
    large = light(LightShape.RECTANGLE, (0.0, 0.0, 1.5), (1.2, 0.0, 0.0), (0.0, -1.2, 0.0), radiance=1.0)
    small = light(LightShape.RECTANGLE, (0.1, 0.1, 4.0), (0.006, 0.0, 0.0), (0.0, -0.006, 0.0), radiance=100.0)
    view, settings = view_from_above(2.0, (32, 32)), with_quality(SMALL_SETTINGS, samples=64)
    graph, constants = metal(0.05)
    both, alone = (
        draw(device, floor_of(graph, constants, lights), view, settings).color[..., :3]
        for lights in (join_lights(large, small), small)
    )
    without = draw(device, floor_of(graph, constants, large), view, settings).color[..., :3]
    assert alone.sum() > 1.0
    assert (both - without).sum() == pytest.approx(alone.sum(), rel=0.05)


def test_lobes_that_no_material_has_have_no_targets(device):
    graph, constants = metal(0.5)
    drawn = draw(device, floor_of(graph, constants, light()), view_from_above(2.0, (8, 8)))
    names = {target.name for target in drawn.renderer.graph.targets.sizes}
    assert {"gloss_reflectance", "gloss_rise", "ltc_entries"} <= names and not names & {"coat", "rare_lobes"}
    drawn = draw(
        device,
        make_scene([quad((-1.0, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0))], light()),
        view_from_above(2.0, (8, 8)),
    )
    assert not {target.name for target in drawn.renderer.graph.targets.sizes} & {
        "gloss_reflectance",
        "coat",
        "rare_lobes",
    }


def test_materials_beside_one_of_rare_lobes_look_the_same(device):
    """Also those whose program does not draw the targets of rare lobes."""
    graph, constants = metal(0.5)
    builder = Builder()
    sheen = builder.call("closure_sheen", constant((0.5, 0.5, 0.5)), constant(0.5), builder.call("geometry_normal"))
    rare, rare_constants = builder.finish([sheen])
    scene = floor_of(graph, constants, light(LightShape.SUN, radius=0.01))
    materials = replace(
        materials_of([(0.5, 0.5, 0.5)] * 2),
        graph=np.int32([0, 1]),
        first_constant=np.int32([0, len(constants)]),
        constants=np.concatenate([constants, rare_constants]),
    )
    view = view_from_above(2.0, (16, 16))
    alone = draw(device, scene, view).color
    beside = draw(device, replace(scene, materials=materials, graphs=(graph, rare)), view).color
    assert np.allclose(beside, alone, rtol=1e-3)


@pytest.mark.parametrize("source", ["sun", "world"])
@pytest.mark.parametrize("roughness", [0.15, 0.5])
def test_a_roof_is_between_a_metal_and_what_is_infinitely_far_away(device, source, roughness):
    lights = light(LightShape.SUN, radius=0.3) if source == "sun" else None
    scene = floor_of(*metal(roughness), lights)
    roof = replace(quad((-9.0, -9.0, 2.5), (18.0, 0.0, 0.0), (0.0, 18.0, 0.0)), materials=np.zeros(2, np.uint32))
    covered = make_scene([*scene.meshes, roof], lights, world=float(source == "world"))
    covered = replace(covered, materials=scene.materials, graphs=scene.graphs)
    instances = replace(covered.instances, visible=np.array([True, False]))
    settings = with_quality(replace(SMALL_SETTINGS, shadow=Shadow()), samples=64)
    view = view_from_above(2.0, (16, 16))
    shaded = draw(device, replace(covered, instances=instances), view, settings).color[..., :3]
    lit = draw(device, replace(scene, world=covered.world), view, settings).color[..., :3]
    assert lit.mean() > 0.05
    assert abs(shaded.mean()) < 0.03 * lit.mean()


def test_the_shape_of_sheen_is_stored_precisely(device):
    """In all of Cycles' table: the peak of a narrow lobe is inversely proportional to the square of its values."""
    shapes = lookup.tables()["sheen"][..., :2].reshape(-1, 2).astype(np.float64)
    lobes = "RareLobes(vec3(0.5), a0, 1.0, 0.0, 0.0, 0.0, false)"
    stored = f"unpack_rare_lobes(pack_rare_lobes({lobes})).sheen_shape"
    result = glsl_functions.evaluate(device, "materials/gloss_packing.glsl", stored, [shapes])[:, :2]
    assert np.abs(result - shapes).max() < 2e-5
