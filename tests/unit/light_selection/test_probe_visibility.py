# SPDX-License-Identifier: GPL-3.0-or-later
"""The first look: one ray from every fourth pixel to each light that casts shadows."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.gl.render_targets import size_of
from ism_addon.resources import POSITION, PROBE, PROBES
from tests.scenes.small import box_over_plane, pillar_field
from tests.support import reference
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

#: Pixels whose ray passes an edge more closely than float32 and a light of a millimetre can tell.
EDGE = 0.02


def scouted(drawn) -> dict[int, np.ndarray]:
    """Of each light, (H/2,W/2,2): rays that arrived, and rays."""
    size = size_of(PROBE, *drawn.renderer.graph.targets.sizes[POSITION])
    return {int(index): read_texels(texture, size) / 255 for index, texture in drawn.renderer.graph[PROBES].items()}


def shrunk(scene, part: float = 1e-3):
    """The lights so small that all of one is seen, or nothing."""
    lights = scene.lights
    return replace(scene, lights=replace(lights, axis_u=part * lights.axis_u, axis_v=part * lights.axis_v))


@pytest.mark.parametrize("make", [box_over_plane, pillar_field])
@pytest.mark.parametrize("size", [(48, 32), (37, 23), (1, 1)])
def test_a_ray_from_every_fourth_pixel(device, make, size):
    scene, view = make(*size)
    scene = shrunk(scene)
    (found,) = scouted(draw(device, scene, view)).values()
    surface = reference.surfaces(scene, view)
    normals = reference.shading_normals(scene, surface)
    blockers = reference.world_triangles(scene, scene.instances.casts_shadow)
    reached = reference.irradiance_per_area(surface.position, normals, scene.lights.position[0], scene.lights, 0) > 0.0
    asked = surface.seen & reached
    seen = asked & reference.visible(surface.position + 1e-4 * surface.facet, scene.lights.position, blockers)[0]
    rows = [grid.reshape(size[::-1])[::2, ::2] for grid in (seen, asked)]
    assert found.shape == (*rows[0].shape, 2)
    for channel, expected in enumerate(rows):
        assert (found[..., channel] != expected).mean() <= EDGE
    if size != (1, 1):
        assert 0.02 < rows[0].mean() < rows[1].mean() < 1.0


def test_all_rays_together_find_all_of_the_light(device):
    """A screen's edge hides a third of the light from everywhere on a small floor: so for a third of the rays."""
    floor = quad((-1e-3, -1e-3, 0), (2e-3, 0, 0), (0, 2e-3, 0))
    screen = quad((-3.0, -3.0, 1.0), (3.0 - 1.0 / 12.0, 0, 0), (0, 6, 0))
    lamp = light(position=(0, 0, 2.0), axis_u=(1, 0, 0), axis_v=(0, -1, 0))
    (found,) = scouted(
        draw(device, make_scene([floor, screen], lamp), view_from_above(1e-3, (64, 64), height=0.5))
    ).values()
    assert (found[..., 1] == 1.0).all()
    assert found[..., 0].mean() == pytest.approx(2.0 / 3.0, abs=0.02)
    blocks = found[..., 0].reshape(8, 4, 8, 4).mean((1, 3))
    assert np.abs(blocks - 2.0 / 3.0).max() < 0.2, "each neighbourhood's rays find it, too: random ones miss it by 0.35"


def test_lights_without_shadows_are_not_scouted_and_two_have_places_of_their_own(device):
    scene, view = box_over_plane(64, 48)
    lamps = replace(
        join_lights(join_lights(scene.lights, light()), scene.lights), casts_shadow=np.array([True, False, True])
    )
    found = scouted(draw(device, replace(scene, lights=lamps), view))
    assert set(found) == {0, 2}
    asked = (found[0][..., 1] == 1.0) & (found[2][..., 1] == 1.0)
    assert asked.mean() > 0.5
    assert (found[0][..., 0] != found[2][..., 0])[asked].any()


def test_only_the_first_sample_scouts(device):
    scene, view = box_over_plane(32, 24)
    drawn = draw(device, scene, view, with_quality(SETTINGS, samples=5))
    assert drawn.profile.rows["ProbeVisibility"].drawn == 1
    off = replace(SETTINGS, shadow=replace(SETTINGS.shadow, enabled=False))
    assert draw(device, scene, view, off).profile.rows["ProbeVisibility"].drawn == 0
