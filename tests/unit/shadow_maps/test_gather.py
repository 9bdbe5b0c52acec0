# SPDX-License-Identifier: GPL-3.0-or-later
"""Gathered light at any receiver against closed forms and dense sums over the light, and self-shadowing."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.gl.shader_records import packed_octahedron
from ism_addon.gpu.passes.shadow_maps.atlas import batches
from ism_addon.gpu.passes.shadow_maps.fill_holes import FillHoles
from ism_addon.gpu.passes.shadow_maps.gather import GatherLight
from ism_addon.gpu.passes.shadow_maps.splat import SplatMaps
from ism_addon.gpu.passes.shadow_maps.virtual_lights import PlaceVirtualLights
from ism_addon.gpu.passes.upload.cull_meshes import CullMeshes
from ism_addon.gpu.passes.upload.upload_lights import UploadLights
from ism_addon.gpu.passes.upload.upload_scene import UploadInstances, UploadMeshes
from ism_addon.gpu.profile import Profile
from ism_addon.resources import (
    ATLAS_BATCH,
    BASE_COLOR,
    CONTRIBUTING_LIGHTS,
    DIRECT_PREDICTION,
    NORMAL,
    POSITION,
    RECEIVER_REGION,
)
from ism_addon.scene import LightShape
from tests.support import reference_irradiance
from tests.support.light_grids import irradiance
from tests.support.small_scenes import (
    AREA_SHAPES,
    draw,
    first_frame,
    join_lights,
    light,
    make_scene,
    quad,
    view_from_above,
    with_shadow,
    write_texels,
)

SHAPES = AREA_SHAPES
DISTANCES = (1e-3, 1e-2, 0.1, 0.5, 1.0, 3.0, 10.0, 30.0, 100.0, 1e3)


def gathered(device, lights, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(N,3) irradiance of unoccluded receivers (N,3): radiance with a base color of pi."""
    points, normals = np.atleast_2d(points), np.atleast_2d(normals)
    size = (len(points), 1)
    renderer, frame = first_frame(device, make_scene([], lights), with_shadow(enabled=False), size)
    frame[CONTRIBUTING_LIGHTS] = tuple(range(len(lights.shape)))
    frame[RECEIVER_REGION] = None
    for pass_type in (CullMeshes, UploadMeshes, UploadInstances, UploadLights, PlaceVirtualLights):
        renderer.graph.step(pass_type, frame, Profile())
    surface = np.concatenate([points - frame.anchor, np.ones((len(points), 1))], 1)
    packed = np.zeros((len(normals), 4), np.uint32)
    packed[:, :2] = np.ascontiguousarray(packed_octahedron(normals)).view(np.uint32)
    color = np.tile([np.pi, np.pi, np.pi, 0.0], (len(points), 1))
    for target, rows in ((POSITION, np.float32(surface)), (NORMAL, packed), (BASE_COLOR, np.float32(color))):
        frame.graph.targets.allocate(target, size)
        write_texels(frame[target], rows[None])
    (frame[ATLAS_BATCH],) = batches(0, 8, device.texture_size)
    for pass_type in (SplatMaps, FillHoles, GatherLight):
        renderer.graph.step(pass_type, frame, Profile())
    return frame.graph.targets.read(DIRECT_PREDICTION)[0, :, :3].astype(float)


def unit(vectors) -> np.ndarray:
    vectors = np.asarray(vectors, float)
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def tilted_light(shape, **more):
    return light(shape, (0.3, -0.2, 0.5), (0.9, 0.2, 0.1), (-0.1, 0.3, 0.3), **more)


def assert_agrees(device, lights, points, normals, floor: float = 1e-9) -> None:
    """Compare with the closed form: the error is at most a thousandth of the truth, or of `floor` if that is more."""
    ours = gathered(device, lights, points, normals)[:, 0]
    truth = np.array([reference_irradiance.irradiance(p, n, lights) for p, n in zip(points, normals, strict=True)])
    error = np.abs(ours - truth) / np.maximum(truth, floor)
    assert error.max() <= 1e-3, (error.argmax(), ours[error.argmax()], truth[error.argmax()])


@pytest.mark.parametrize("shape", SHAPES)
def test_all_distances(device, shape):
    """Receivers in front of the light and to its sides, facing it, 1/1000 to 1000 light sizes away."""
    lights = tilted_light(shape)
    normal = lights.normal[0]
    size = np.linalg.norm(lights.axis_u[0])
    directions = unit([normal, normal + 0.5 * unit(lights.axis_u[0]), normal - 0.7 * unit(lights.axis_v[0])])
    points = np.array([lights.position[0] + distance * size * each for distance in DISTANCES for each in directions])
    assert_agrees(device, lights, points, unit(lights.position[0] - points))


@pytest.mark.parametrize("shape", SHAPES)
def test_receivers_whose_horizon_cuts_the_light(device, shape):
    lights = tilted_light(shape)
    points, normals = [], []
    across = unit(lights.axis_u[0] + 0.4 * lights.axis_v[0])
    for distance in (0.1, 0.3, 1.0, 2.0):
        for tilt in (60.0, 80.0, 90.0, 100.0):
            points.append(lights.position[0] + distance * lights.normal[0])
            normals.append(np.sin(np.radians(tilt)) * across - np.cos(np.radians(tilt)) * lights.normal[0])
    assert_agrees(device, lights, np.array(points), np.array(normals), floor=0.02)


@pytest.mark.parametrize("shape", SHAPES)
def test_receivers_anywhere(device, shape):
    random = np.random.default_rng(4)
    lights = tilted_light(shape)
    points = lights.position[0] + random.normal(size=(40, 3)) + lights.normal[0]
    normals = unit(random.normal(size=(40, 3)))
    assert_agrees(device, lights, points, normals, floor=0.02)


def test_irradiance_is_zero_behind_the_light_and_facing_away(device):
    lights = tilted_light(LightShape.RECTANGLE)
    normal = lights.normal[0]
    points = lights.position[0] + np.outer([-1.0, -1e-3, 1.0], normal)
    assert not gathered(device, lights, points, np.array([normal, normal, normal])).any()


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("spread", np.radians([150.0, 90.0, 30.0]))
def test_a_spread_limits_the_light_to_a_cone(device, shape, spread):
    """Within 2 % of the brightest receiver."""
    lights = tilted_light(shape, spread=spread)
    normal, across = lights.normal[0], unit(lights.axis_u[0])
    points = np.array(
        [lights.position[0] + d * normal + d * s * across for d in (1.0, 3.0, 20.0) for s in (0.0, 0.2, 0.6, 1.5)]
    )
    normals = np.tile(-normal, (len(points), 1))
    ours = gathered(device, lights, points, normals)[:, 0]
    truth = np.array([irradiance(p, n, lights, 0) for p, n in zip(points, normals, strict=True)])
    for rows in np.arange(len(points)).reshape(3, -1):
        assert ours[rows] == pytest.approx(truth[rows], abs=0.02 * truth[rows].max())


def test_an_unoccluded_floor_does_not_shadow_itself(device):
    """The maps hold the floor's own distances. The bias moves receivers towards the light."""
    plate, view = quad((-2.0, -2.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0)), view_from_above(3.0, (24, 24))
    scene = make_scene([plate], light(position=(0.0, 0.0, 1.0)))
    pictures = [draw(device, scene, view, with_shadow(enabled=enabled)).color[..., :3] for enabled in (True, False)]
    assert pictures[1].min() > 0.0
    assert (pictures[0] / pictures[1]).min() > 0.98


def test_lights_add_up_with_their_colours(device):
    one, two = tilted_light(LightShape.RECTANGLE), light(LightShape.ELLIPSE, (-1.0, 0.0, 1.0), radiance=3.0)
    colored = replace(two, emission=np.array([[3.0, 1.0, 0.5]], np.float32))
    point, normal = np.array([[0.1, 0.2, -0.5]]), np.array([[0.0, 0.0, 1.0]])
    expected = gathered(device, one, point, normal) + gathered(device, colored, point, normal)
    assert gathered(device, join_lights(one, colored), point, normal) == pytest.approx(expected, rel=1e-5)
