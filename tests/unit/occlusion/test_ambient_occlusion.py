# SPDX-License-Identifier: GPL-3.0-or-later
"""Ambient occlusion compared with traced rays, and what its settings do."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.choices import OcclusionSampling
from ism_addon.resources.world import RAW_OCCLUSION
from ism_addon.scene import World
from ism_addon.settings import SSAO
from tests.scenes.small import subdivided_box
from tests.support import reference
from tests.support.small_scenes import SMALL_SETTINGS, draw, light, look_at, make_scene, quad, with_quality

HEMISPHERE_SSAO = SSAO(radius=0.5, cone_angle=math.pi, intensity=1.0, attenuation=0.0)
HORIZONS, POINTS, TRACED = OcclusionSampling


def mean_occlusion(device, scene, view, ssao: SSAO, samples: int = 24, target: str = "raw_occlusion") -> np.ndarray:
    """(H/2,W/2): the target's average over samples."""
    settings = replace(with_quality(SMALL_SETTINGS, samples=samples), ssao=ssao, debug_view=target)
    return draw(device, scene, view, settings).color[::2, ::2, 0].astype(float)


def corner():
    """A floor and a wall at right angles, seen along their bisector."""
    floor, wall = quad((-4, -4, 0), (8, 0, 0), (0, 4, 0)), quad((-4, 0, 0), (8, 0, 0), (0, 0, 4))
    return make_scene([floor, wall], world=1.0), look_at(
        (0.0, -4.0, 4.0), (0.0, 0.0, 0.0), (96, 96), math.radians(25.0)
    )


def half_resolution_surface(scene, view):
    """The surfaces of all pixels, and the indices (H/2,W/2) of those that half-resolution pixels stand for."""
    surface = reference.surfaces(scene, view)
    rows = np.arange(view.width * view.height).reshape(view.height, view.width)[::2, ::2]
    return surface, rows


def test_a_plane_is_unoccluded(device):
    scene, view = (
        make_scene([quad((-50, -50, 0), (100, 0, 0), (0, 100, 0))], world=1.0),
        look_at((0.0, -4.0, 1.0), size=(64, 48)),
    )
    for ssao in (HEMISPHERE_SSAO, SSAO(), replace(HEMISPHERE_SSAO, radius=5.0), SSAO(sampling=POINTS)):
        assert (mean_occlusion(device, scene, view, ssao, 4) == 1.0).all()


def test_a_ball_is_unoccluded(device):
    """A convex body does not occlude itself, except for the angles of its triangles and the width of pixels."""
    from tests.scenes.small import sphere

    scene, view = make_scene([sphere((0, 0, 0), 1.0, 64, 32)], world=1.0), look_at((0.0, -4.0, 1.0), size=(64, 48))
    assert mean_occlusion(device, scene, view, HEMISPHERE_SSAO, 8).mean() > 0.98


SETTINGS = [
    HEMISPHERE_SSAO,
    SSAO(),
    replace(HEMISPHERE_SSAO, cone_angle=1.5, attenuation=4.0),
    replace(HEMISPHERE_SSAO, radius=0.9),
]


def boxes_on_a_floor():
    """A scene, its view, and the camera's position."""
    floor = quad((-6, -6, 0), (12, 0, 0), (0, 12, 0))
    boxes = [
        subdivided_box((-0.5, -0.4, 0.0), (0.5, 0.4, 0.8), 1),
        subdivided_box((0.7, -0.9, 0.0), (1.0, 0.9, 0.5), 1),
    ]
    position = (2.5, -4.0, 3.0)
    view = look_at(position, (0.2, 0.0, 0.2), (64, 48), math.radians(40.0))
    return make_scene([floor, *boxes], world=1.0), view, np.array(position)


def inner_surface(scene, view):
    """Which half-resolution pixels (H/2,W/2) are compared, their positions and normals, and all triangles."""
    surface, rows = half_resolution_surface(scene, view)
    inner = np.zeros(rows.shape, bool)
    inner[4:-4:2, 4:-4:2] = True
    chosen = rows[inner]
    triangles = reference.world_triangles(scene, scene.instances.visible)
    return inner, surface.position[chosen], surface.geometric_normal[chosen], triangles


@pytest.mark.parametrize("ssao", SETTINGS)
def test_points_compared_with_the_reference(device, ssao):
    scene, view, camera = boxes_on_a_floor()
    ours = mean_occlusion(device, scene, view, replace(ssao, sampling=POINTS), 32)
    inner, *surface = inner_surface(scene, view)
    truth = reference.ambient_visibility(*surface, camera, ssao.radius, ssao.cone_angle, ssao.attenuation)
    error = ours[inner] - truth
    assert truth.min() < 0.9
    assert abs(error.mean()) < 0.002
    assert np.sqrt((error**2).mean()) < 0.14 * np.sqrt(((1.0 - truth) ** 2).mean())  # measured: up to 0.115


@pytest.mark.parametrize("ssao", SETTINGS)
def test_horizons_are_nearer_to_rays_than_points(device, ssao):
    """What no surface on the screen hides is too light: boxes have sides that the camera does not see."""
    scene, view, _ = boxes_on_a_floor()
    inner, *surface = inner_surface(scene, view)
    truth = reference.ray_traced_occlusion(*surface, ssao.radius, ssao.cone_angle, ssao.attenuation)
    errors = [
        mean_occlusion(device, scene, view, replace(ssao, sampling=sampling), 32)[inner] - truth
        for sampling in (HORIZONS, POINTS)
    ]
    horizons, points = (np.sqrt((error**2).mean()) for error in errors)
    assert horizons < 0.9 * points
    assert abs(errors[0].mean()) < abs(errors[1].mean())


def test_a_corner_is_as_dark_as_by_rays(device):
    scene, view = corner()
    ours = mean_occlusion(device, scene, view, replace(HEMISPHERE_SSAO, thickness=10.0), 64)
    inner, *surface = inner_surface(scene, view)
    truth = reference.ray_traced_occlusion(*surface, 0.5, math.pi, 0.0)
    assert truth.min() < 0.55
    assert np.sqrt(((ours[inner] - truth) ** 2).mean()) < 0.05


def test_light_passes_behind_thin_surfaces(device):
    """A bar above a floor hides less the thinner it is."""
    bar = subdivided_box((-2.0, -0.05, 0.25), (2.0, 0.05, 0.3), 1)
    floor = quad((-6, -6, 0), (12, 0, 0), (0, 12, 0))
    view = look_at((0.0, -3.0, 3.0), (0.0, 0.0, 0.0), (96, 72), math.radians(30.0))
    scene = make_scene([floor, bar], world=1.0)
    dark = [
        1.0 - mean_occlusion(device, scene, view, replace(HEMISPHERE_SSAO, thickness=thickness), 16).mean()
        for thickness in (0.0, 0.2, 1.0)
    ]
    assert dark[0] < 0.8 * dark[1] < 0.8 * dark[2]


@pytest.mark.parametrize("sampling", OcclusionSampling)
def test_settings_change_the_occlusion_in_their_direction(device, sampling):
    scene, view = corner()

    def darkening(**changes: float) -> float:
        ssao = replace(HEMISPHERE_SSAO, sampling=sampling, **changes)
        return 1.0 - float(mean_occlusion(device, scene, view, ssao, 4, "sample_color").mean()) / 0.6

    for name, values in (
        ("radius", (0.1, 0.3, 0.9)),
        ("intensity", (0.2, 0.6, 1.5)),
        ("power", (0.5, 1.0, 2.0)),
        ("cone_angle", (math.radians(95), math.radians(120), math.pi)),
    ):
        darkenings = [darkening(**{name: value}) for value in values]
        assert darkenings[0] < darkenings[1] < darkenings[2], name
    darkenings = [darkening(attenuation=value) for value in (0.0, 1.0, 8.0)]
    assert darkenings[0] > darkenings[1] > darkenings[2] > 0.0


def test_darkening_is_linear_in_intensity_until_black(device):
    scene, view = corner()
    dark = {
        intensity: 1.0
        - mean_occlusion(device, scene, view, replace(HEMISPHERE_SSAO, intensity=intensity), 1, "sample_color") / 0.6
        for intensity in (0.5, 1.0, 1.5, 10.0)
    }
    assert dark[1.0] == pytest.approx(2.0 * dark[0.5], abs=2e-3)
    assert dark[1.5] == pytest.approx(np.minimum(3.0 * dark[0.5], 1.0), abs=3e-3)
    assert dark[10.0].max() == pytest.approx(1.0, abs=1e-3)


def test_attenuation_fades_to_nothing_at_the_radius(device):
    """Between a floor and a ceiling, occlusion begins where the radius is their distance."""
    planes = [quad((-9, -9, 0), (18, 0, 0), (0, 18, 0)), quad((-9, -9, 1), (0, 18, 0), (18, 0, 0))]
    scene, view = (
        make_scene(planes, world=1.0),
        look_at((0.0, -4.0, 0.5), (0.0, 0.0, 0.5), (64, 48), math.radians(60.0)),
    )

    def darkening(attenuation: float, radius: float) -> float:
        ssao = replace(HEMISPHERE_SSAO, radius=radius, attenuation=attenuation)
        return 1.0 - float(mean_occlusion(device, scene, view, ssao, 8).mean())

    assert darkening(1.0, 0.98) == darkening(0.0, 0.98) == 0.0
    assert darkening(0.0, 1.1) > 0.01 and darkening(1.0, 1.1) < 0.25 * darkening(0.0, 1.1)


@pytest.mark.parametrize("off", [{"enabled": False}, {"intensity": 0.0}, {"radius": 0.0}])
def test_switched_off_it_is_not_drawn_and_changes_nothing(device, off):
    scene, view = corner()
    drawn = draw(device, scene, view, replace(SMALL_SETTINGS, ssao=replace(HEMISPHERE_SSAO, **off)))
    assert drawn.profile.rows["AmbientOcclusion"].drawn == drawn.profile.rows["BlurOcclusion"].drawn == 0
    assert RAW_OCCLUSION not in drawn.renderer.graph.targets.textures
    assert drawn.color[..., :3] == pytest.approx(0.6, abs=1e-3)


def test_with_a_black_world_it_is_not_drawn(device):
    scene, view = corner()
    dark = replace(scene, world=World.even(np.zeros(3, np.float32)), lights=light())
    drawn = draw(device, dark, view, replace(SMALL_SETTINGS, ssao=HEMISPHERE_SSAO))
    assert drawn.profile.rows["AmbientOcclusion"].drawn == 0


def test_it_darkens_only_the_light_of_the_world(device):
    """SSAO does not change direct light."""
    scene, view = corner()
    lit = replace(scene, lights=light(position=(0.0, -1.5, 3.0)))
    without_ssao = draw(device, lit, view)
    with_ssao = draw(device, lit, view, replace(SMALL_SETTINGS, ssao=HEMISPHERE_SSAO))
    occlusion = (without_ssao.color - with_ssao.color)[..., :3] / 0.6
    assert (occlusion > -1e-3).all()
    assert occlusion.max() < 0.6
    assert np.array_equal(without_ssao.target("direct_prediction"), with_ssao.target("direct_prediction"))


def test_far_occluders_do_not_darken(device):
    """A plate in front of the wall, farther away than the radius, leaves no halo."""
    wall = quad((-10, 3, -10), (20, 0, 0), (0, 0, 20))
    plate = quad((-0.5, 0, -0.5), (1, 0, 0), (0, 0, 1))
    view = look_at((0.0, -4.0, 0.0), size=(64, 48))
    assert (mean_occlusion(device, make_scene([wall, plate], world=1.0), view, HEMISPHERE_SSAO, 4) == 1.0).all()
