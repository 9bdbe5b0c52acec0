# SPDX-License-Identifier: GPL-3.0-or-later
"""The contents of the G-buffer against rays through the pixels' centres."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.gl import depth
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.gl.shader_records import directions_from_octahedron
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.sampling.pixel_grid import pixel_grid, samples_per_visibility_buffer
from tests.scenes.small import sphere
from tests.support import reference
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    look_at,
    make_scene,
    perspective,
    quad,
    random_triangles,
    transform,
    view_from_above,
    with_quality,
)

#: Fraction of pixels whose centre is too close to an edge for float32.
EDGE = 0.01

SHEAR = np.array([[1.0, 0.7, 0.0], [0.0, 0.6, 0.3], [0.2, 0.0, 1.4]])
MIRROR = np.diag([-1.0, 1.0, 0.5])


@pytest.fixture(params=["nearness", "logarithm"])
def depth_device(request):
    """The usual device, and one as on macOS, where depth is the logarithm of the distance."""
    if request.param == "nearness":
        yield request.getfixturevalue("device")
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(depth, "maps_to_zero", lambda gl: False)
        other = open_device()
    with other.gl as gl:
        yield other
        assert gl.error == "GL_NO_ERROR"
    other.close()


def gbuffer(device, scene, view):
    """(N,components) of each target by name, one row per pixel."""
    drawn = draw(device, scene, view)
    anchor = drawn.renderer.frame(scene, view, SMALL_SETTINGS, 0, drawn.profile).anchor
    targets = {
        name: drawn.target(name).reshape(view.width * view.height, -1)
        for name in ("depth", "position", "normal", "base_color", "primitive")
    }
    targets["world"] = targets["position"][:, :3] + anchor
    targets["smooth"] = directions_from_octahedron(targets["normal"][:, :2])
    targets["geometric"] = directions_from_octahedron(targets["normal"][:, 2:])
    return targets


def compare(device, scene, view, tolerance: float = 1e-4) -> None:
    """Check the G-buffer against the reference, except at edges; positions to `tolerance` m."""
    ours, truth = gbuffer(device, scene, view), reference.surfaces(scene, view)
    smooth = reference.shading_normals(scene, truth)
    exists = ours["position"][:, 3] > 0.0
    assert exists.any()
    assert (ours["depth"][~exists] == np.float32(1e10)).all()
    same = (exists == truth.exists) & (~exists | (np.abs(ours["world"] - truth.position).max(1) < tolerance))
    assert (~same).mean() <= EDGE
    both = exists & truth.exists & same
    assert ours["depth"][both, 0] == pytest.approx(truth.depth[both], rel=1e-4, abs=tolerance)
    assert (np.abs(ours["geometric"] - truth.geometric_normal)[both].max(1) > 2e-3).mean() <= EDGE
    assert (np.abs(ours["smooth"] - smooth)[both].max(1) > 5e-3).mean() <= EDGE


def objects(matrices=None, mesh_ids=None):
    """Random triangles, a smooth sphere, and a slanted floor."""
    meshes = [random_triangles(60), sphere((0.4, -0.3, 0.2), 0.7, 16, 8), quad((-2, -2, -1), (4, 0, 0), (0, 4, 0.5))]
    return make_scene(meshes, matrices=matrices, mesh_ids=mesh_ids)


@pytest.mark.parametrize(
    "position", [(3.0, -3.0, 2.0), (0.1, 0.2, 6.0), (-2.0, 0.5, -3.0)], ids=["front", "above", "below"]
)
def test_positions_normals_and_depths(depth_device, position):
    compare(depth_device, objects(), look_at(position, size=(64, 48)))


def test_orthographic(depth_device):
    compare(depth_device, objects(), view_from_above(4.0, (60, 40)))


def test_a_shifted_camera_with_pixels_that_are_not_square(device):
    view = look_at((3.0, -3.0, 2.0), size=(64, 48))
    clip_from_view = view.clip_from_view.copy()
    clip_from_view[0] *= 1.7
    clip_from_view[:2, 2] = 0.3, -0.2
    compare(device, objects(), replace(view, clip_from_view=clip_from_view))


def test_mirrored_sheared_and_repeated_instances(device):
    matrices = [
        transform(),
        transform(MIRROR, (1.5, 0.0, 0.0)),
        transform(SHEAR, (-1.5, 0.5, 0.3)),
        transform(-0.6 * np.eye(3), (0.0, 2.0, 0.5)),
        transform(),
    ]
    compare(device, objects(matrices, [1, 1, 1, 1, 2]), look_at((3.0, -5.0, 3.0), size=(80, 60)))


@pytest.mark.parametrize("offset", [1e4, 1e6])
def test_far_from_the_worlds_origin(device, offset):
    """Everything including the camera is far away: positions are still exact to a tenth of a millimetre."""
    far = np.array([offset, -offset, 0.5 * offset]) + (0.123, 0.456, 0.789)
    scene = objects([transform(offset=far)] * 3)
    view = look_at(far + (3.0, -3.0, 2.0), far, size=(48, 36))
    compare(device, scene, view)


def test_a_mesh_far_from_its_own_origin(device):
    """Object coordinates of 1000 m that the instance's matrix moves back: no float32 precision is lost."""
    floor = quad((1000.0, 1000.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.3))
    scene = make_scene([floor], matrices=[transform(offset=(-1001.0, -1001.0, 0.0))])
    compare(device, scene, look_at((1.0, -3.0, 2.0), size=(48, 36)))


def test_the_nearer_of_two_surfaces_is_visible(depth_device):
    """They are a millimetre apart at a distance of ten metres."""
    near, far = quad((-1, -1, 1e-3), (2, 0, 0), (0, 2, 0)), quad((-1, -1, 0), (2, 0, 0), (0, 2, 0))
    for order in ([near, far], [far, near]):
        ours = gbuffer(depth_device, make_scene(order), view_from_above(1.0, (16, 16)))
        assert ours["world"][:, 2] == pytest.approx(1e-3, abs=2e-4)


@pytest.mark.parametrize("distance", [10.0, 100.0, 500.0])
def test_depth_separates_close_surfaces_despite_a_close_near_plane(depth_device, distance):
    """Blender's viewports clip at 1 cm and at 1 km by default."""
    gap, width = 1e-4 * distance, 2.0 * distance
    near, far = (quad((-0.5 * width, -0.5 * width, z), (width, 0, 0), (0, width, 0)) for z in (gap, 0.0))
    view = look_at((0.0, -0.6 * distance, 0.8 * distance))
    view = replace(view, clip_from_view=perspective(math.radians(50.0), 32 / 24, 0.01, 1000.0))
    for order in ([near, far], [far, near]):
        ours = gbuffer(depth_device, make_scene(order), view)
        assert ours["world"][:, 2] == pytest.approx(gap, abs=0.2 * gap)


def test_invisible_instances_are_not_drawn(depth_device):
    scene = objects()
    hidden = replace(scene, instances=replace(scene.instances, visible=np.array([True, False, True])))
    compare(depth_device, hidden, look_at((3.0, -3.0, 2.0), size=(48, 36)))


def test_odd_picture_sizes(device):
    """Down to one pixel."""
    for size in ((1, 1), (1, 9), (33, 1), (17, 31)):
        compare(device, objects(), look_at((3.0, -3.0, 2.0), size=size))


def test_a_scene_without_triangles(device):
    ours = gbuffer(device, make_scene([]), look_at((3.0, -3.0, 2.0)))
    assert not ours["position"].any()
    assert (ours["depth"] == np.float32(1e10)).all()


@pytest.mark.parametrize("samples", [3, 4, 16], ids=["a grid each", "four share one", "sixteen share one"])
def test_the_sample_moves_the_pixels_centres(device, samples):
    """The second and the last sample against rays through their own subpixel offsets, for each grid size."""
    view = replace(look_at((3.0, -3.0, 2.0), size=(48, 36)), filter_width=1.5)
    settings = with_quality(SMALL_SHADOW_MAPS, samples=samples)
    for newest in {1, samples - 1}:
        drawn = draw(device, objects(), view, settings, last=newest)
        count = samples_per_visibility_buffer(view.width, view.height, samples, device.texture_size)
        offset = pixel_grid(newest // count, count).subpixel_offsets[newest % count]
        shift = np.eye(4)
        shift[:2, 3] = -2.0 * offset / (48, 36)
        moved = replace(view, clip_from_view=shift @ view.clip_from_view)
        truth = reference.surfaces(objects(), moved)
        error = np.abs(drawn.target("depth").reshape(-1) - np.where(truth.exists, truth.depth, np.float32(1e10)))
        assert offset.any()
        assert (error > 1e-3).mean() <= EDGE


def test_a_low_latency_first_sample_has_its_own_visibility_buffer_and_the_picture_is_the_same(device):
    """Otherwise the first sample shares a visibility buffer with those that follow."""
    scene, view = objects(), replace(look_at((3.0, -3.0, 2.0), size=(48, 36)), filter_width=1.5)
    settings, drawn, pictures = with_quality(SMALL_SHADOW_MAPS, samples=4), {}, {}
    for low_latency in (True, False):
        renderer, drawn[low_latency] = Renderer(device), []
        for sample in range(4):
            profile = Profile()
            list(renderer.sample(scene, view, settings, sample, profile, low_latency))
            drawn[low_latency].append(profile.counts["triangles_drawn"])
        pictures[low_latency] = renderer.picture()
        renderer.release()
    count = scene.triangle_count
    assert drawn == {True: [count, count, 0, 0], False: [count, 0, 0, 0]}
    assert np.abs(pictures[True] - pictures[False]).mean() < 1e-3 * pictures[True].mean()


@pytest.mark.parametrize(("beyond", "drawn"), [(-0.5, 2), (0.5, 2), (1.5, 0)])
def test_meshes_are_drawn_up_to_a_pixel_beyond_the_picture(device, beyond, drawn):
    """Culling is in double precision. The GPU's rounding may differ from it by up to a pixel."""
    plate = quad((1.0 + beyond / 16.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    picture = draw(device, make_scene([plate], world=1.0), view_from_above(2.0, (32, 32)))
    assert picture.profile.counts["triangles_drawn"] == drawn
