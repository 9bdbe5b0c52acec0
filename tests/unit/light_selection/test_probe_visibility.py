# SPDX-License-Identifier: GPL-3.0-or-later
"""Visibility probes: one ray from every fourth pixel (one of 2×2) to each light that casts shadows."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.gl.render_targets import size_of
from ism_addon.gpu.passes.light_selection import probe_visibility
from ism_addon.gpu.passes.light_selection.probe_rays import SHADER
from ism_addon.resources import POSITION, PROBE, PROBES
from ism_addon.scene import LightShape
from tests.scenes.small import box_over_plane, pillar_field
from tests.support import reference
from tests.support.light_grids import irradiance_per_area
from tests.support.small_scenes import SMALL_SETTINGS as SETTINGS
from tests.support.small_scenes import (
    draw,
    join_lights,
    light,
    make_scene,
    quad,
    read_texels,
    view_from_above,
    with_quality,
)

#: Fraction of pixels whose ray passes an edge too closely for float32 and for a light of a millimetre.
EDGE = 0.02


def probes(drawn) -> dict[int, np.ndarray]:
    """For each light (H/2,W/2,2): unoccluded rays, and traced rays."""
    size = size_of(PROBE, *drawn.renderer.graph.targets.sizes[POSITION])
    return {int(index): read_texels(texture, size) / 255 for index, texture in drawn.renderer.graph[PROBES].items()}


def with_small_lights(scene, scale: float = 1e-3):
    """The lights so small that each is fully visible or fully occluded."""
    lights = scene.lights
    return replace(scene, lights=replace(lights, axis_u=scale * lights.axis_u, axis_v=scale * lights.axis_v))


@pytest.mark.parametrize("make", [box_over_plane, pillar_field])
@pytest.mark.parametrize("size", [(48, 32), (37, 23), (1, 1)])
def test_a_ray_from_every_fourth_pixel(device, make, size):
    scene, view = make(*size)
    scene = with_small_lights(scene)
    (probed,) = probes(draw(device, scene, view)).values()
    surface = reference.surfaces(scene, view)
    normals = reference.shading_normals(scene, surface)
    occluders = reference.world_triangles(scene, scene.instances.casts_shadow)
    irradiance = irradiance_per_area(surface.position, normals, scene.lights.position[0], scene.lights, 0)
    traced = surface.exists & (irradiance > 0.0)
    starts = surface.position + 1e-4 * surface.geometric_normal
    unoccluded = traced & reference.visible(starts, scene.lights.position, occluders)[0]
    expected = [grid.reshape(size[::-1])[::2, ::2] for grid in (unoccluded, traced)]
    assert probed.shape == (*expected[0].shape, 2)
    for channel, grid in enumerate(expected):
        assert (probed[..., channel] != grid).mean() <= EDGE
    if size != (1, 1):
        assert 0.02 < expected[0].mean() < expected[1].mean() < 1.0


def test_all_rays_together_cover_the_light(device):
    """A screen's edge hides a third of the light from all of a small floor, so a third of the rays is occluded."""
    floor = quad((-1e-3, -1e-3, 0), (2e-3, 0, 0), (0, 2e-3, 0))
    screen = quad((-3.0, -3.0, 1.0), (3.0 - 1.0 / 12.0, 0, 0), (0, 6, 0))
    lights = light(position=(0, 0, 2.0), axis_u=(1, 0, 0), axis_v=(0, -1, 0))
    (probed,) = probes(
        draw(device, make_scene([floor, screen], lights), view_from_above(1e-3, (64, 64), height=0.5))
    ).values()
    assert (probed[..., 1] == 1.0).all()
    assert probed[..., 0].mean() == pytest.approx(2.0 / 3.0, abs=0.02)
    neighbourhoods = probed[..., 0].reshape(8, 4, 8, 4).mean((1, 3))
    assert np.abs(neighbourhoods - 2.0 / 3.0).max() < 0.2, "random rays of a neighbourhood are off by up to 0.35"


def test_lights_without_shadows_are_not_probed_and_each_light_has_its_own_sample_positions(device):
    scene, view = box_over_plane(64, 48)
    lights = replace(
        join_lights(join_lights(scene.lights, light()), scene.lights), casts_shadow=np.array([True, False, True])
    )
    probed = probes(draw(device, replace(scene, lights=lights), view))
    assert set(probed) == {0, 2}
    traced = (probed[0][..., 1] == 1.0) & (probed[2][..., 1] == 1.0)
    assert traced.mean() > 0.5
    assert (probed[0][..., 0] != probed[2][..., 0])[traced].any()


def test_only_the_first_sample_probes(device):
    scene, view = box_over_plane(32, 24)
    drawn = draw(device, scene, view, with_quality(SETTINGS, samples=5))
    assert drawn.profile.rows["ProbeVisibility"].drawn == 1
    unshadowed = replace(SETTINGS, shadow=replace(SETTINGS.shadow, enabled=False))
    assert draw(device, scene, view, unshadowed).profile.rows["ProbeVisibility"].drawn == 0


def test_few_rays_are_traced_by_one_program_to_all_lights(device, monkeypatch):
    """Many by one for each type: the same rays. Coarse probes have the one for all."""
    plane, lights = quad((-2, -2, 0), (4, 0, 0), (0, 4, 0)), [light(), light(LightShape.POINT, radius=0.2)]
    scene, view = make_scene([plane], join_lights(*lights)), view_from_above(2.0, (32, 24))
    results, counts = [], []
    for most in (probe_visibility.MAX_MIXED_RAYS, 0):
        monkeypatch.setattr(probe_visibility, "MAX_MIXED_RAYS", most)
        device.forget_programs()
        results.append(probes(draw(device, scene, view)))
        counts.append(sum({SHADER, "glsl/tiles.vert"} <= set(source.sources) for source in device.programs))
    assert counts == [1, 3]
    for index, probed in results[0].items():
        assert np.array_equal(probed, results[1][index])
