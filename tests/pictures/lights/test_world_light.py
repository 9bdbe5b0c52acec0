# SPDX-License-Identifier: GPL-3.0-or-later
"""The world as a light: occluded by shadow rays in the method Ray Traced, and by ambient occlusion otherwise."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.gl.context import open_device
from ism_addon.scene import Scene, View, World
from ism_addon.settings import SSAO, Method, Settings, Shadow
from ism_addon.spaces import orthonormal
from tests.scenes.small import SMALL
from tests.support import reference
from tests.support.small_scenes import SMALL_SETTINGS, draw, make_scene, quad, view_from_above, with_quality

SETTINGS = replace(SMALL_SETTINGS, shadow=Shadow())
FLOOR = quad((-4, -4, 0), (8, 0, 0), (0, 8, 0))
WALL = quad((0, -50, 0), (0, 100, 0), (0, 0, 50))
COLOR = np.array([0.2, 0.4, 0.8], np.float32)


def lit_by_the_world(scene: Scene, radiance: np.ndarray = COLOR) -> Scene:
    """The scene without its lights, in this world."""
    return replace(scene, lights=scene.lights.select(slice(0)), world=World.even(radiance))


def world_visibility(scene: Scene, view: View, side: int, rows: np.ndarray) -> np.ndarray:
    """(N,): the visible fraction of the world's irradiance at pixels (N,), by side² rays each; nan: no surface."""
    surface, blockers = reference.surfaces(scene, view), reference.world_triangles(scene, scene.instances.casts_shadow)
    a, b = (grid.ravel() for grid in np.meshgrid(*[(np.arange(side) + 0.5) / side] * 2))
    sine, angle = np.sqrt(a), 2.0 * np.pi * b
    directions = np.column_stack([sine * np.cos(angle), sine * np.sin(angle), np.sqrt(1.0 - a)])
    normals, visible = reference.shading_normals(scene, surface), np.full(len(surface.exists), np.nan)
    for row in rows[surface.exists[rows]]:
        basis = np.array(orthonormal(normals[row : row + 1]))[:, 0]
        rays = directions @ np.stack([*basis, normals[row]])
        start = surface.position[row] + 1e-4 * surface.geometric_normal[row]
        visible[row] = (reference.nearest(np.tile(start, (len(rays), 1)), rays, blockers)[0] < 0).mean()
    return visible[rows]


def passes(device, scene: Scene, settings: Settings) -> set[str]:
    """The passes that drew the image."""
    rows = draw(device, scene, view_from_above(4.0, (32, 32)), settings).profile.rows
    return {name for name, row in rows.items() if row.drawn}


def test_the_picture_is_that_of_the_reference(device):
    """Measured: 0.0073."""
    scene, view = SMALL["box over plane"](24, 16)
    scene = lit_by_the_world(scene)
    rows = np.arange(0, 24 * 16, 5)
    visible = world_visibility(scene, view, 24, rows)
    truth = np.where(np.isnan(visible), 1.0, scene.materials.base_color[0, 0] * visible)
    color = draw(device, scene, view, with_quality(SETTINGS, samples=64)).color[..., :3].reshape(-1, 3)[rows]
    assert reference.nrmse(color, truth[:, None] * COLOR) < 0.01
    assert color.mean() == pytest.approx((truth[:, None] * COLOR).mean(), rel=2e-3)


def test_a_wall_hides_half_of_it(device):
    """Of the floor near a wall of nearly infinite size; its color is 0.6."""
    scene = lit_by_the_world(make_scene([FLOOR, WALL]))
    color = draw(device, scene, view_from_above(0.1, (16, 16)), with_quality(SETTINGS, samples=64)).color
    assert color[..., :3].mean((0, 1)) == pytest.approx(0.3 * COLOR, rel=0.01)


def test_where_nothing_occludes_it_there_is_no_noise(device):
    scene = lit_by_the_world(make_scene([FLOOR]))
    drawn = draw(device, scene, view_from_above(4.0, (32, 32)), with_quality(SETTINGS, samples=2))
    assert drawn.color[..., :3] == pytest.approx(np.broadcast_to(0.6 * COLOR, (32, 32, 3)), rel=1e-5)


def test_the_camera_sees_it_once(device):
    scene = lit_by_the_world(make_scene([quad((-1, -1, 0), (2, 0, 0), (0, 2, 0))]))
    background = draw(device, scene, view_from_above(6.0, (32, 32)), SETTINGS).color[0, 0]
    assert background == pytest.approx([*COLOR, 1.0])


def test_what_is_not_needed_is_not_done(device):
    """Without shadows, without objects that cast any, or in a black world no ray is traced and nothing is probed."""
    scene = lit_by_the_world(make_scene([FLOOR, WALL]))
    assert "TraceShadows" in passes(device, scene, SETTINGS)
    none_casts = replace(scene.instances, casts_shadow=np.zeros(2, bool))
    for unlit, settings in (
        (scene, replace(SETTINGS, shadow=Shadow(enabled=False))),
        (scene, replace(SETTINGS, shadow=Shadow(world=False))),
        (replace(scene, instances=none_casts), SETTINGS),
        (lit_by_the_world(scene, np.zeros(3, np.float32)), SETTINGS),
    ):
        assert not passes(device, unlit, settings) & {"CullLights", "ProbeVisibility", "TraceShadows"}


def test_its_shader_is_not_compiled_without_it():
    device = open_device()
    with device.gl:
        scene = replace(make_scene([FLOOR, WALL]), world=World.even(np.zeros(3, np.float32)))
        draw(device, scene, view_from_above(4.0, (32, 32)), with_quality(SETTINGS, samples=2))
    drawn_alone = {constants for _, shader, constants in device.programs if "trace_shadows" in str(shader)}
    assert all(("has_world", 0) in constants for constants in drawn_alone)
    device.close()


@pytest.mark.parametrize(
    ("method", "world", "occlusion"),
    [
        (Method.RAY_TRACED, True, False),
        (Method.RAY_TRACED, False, True),
        (Method.SHADOW_MAPS, False, True),
        (Method.SHADOW_MAPS, True, False),
    ],
)
def test_ambient_occlusion_is_drawn_where_it_has_no_shadows(device, method, world, occlusion):
    scene = lit_by_the_world(make_scene([FLOOR, WALL]))
    settings = replace(SETTINGS, ssao=SSAO(), shadow=Shadow(method=method, world=world, sky_dome=world))
    assert ("AmbientOcclusion" in passes(device, scene, settings)) == occlusion
