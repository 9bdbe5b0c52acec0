# SPDX-License-Identifier: GPL-3.0-or-later
"""What the G-buffer holds against rays through the pixels' centres."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.gl import depth
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.gl.shader_records import directions_from_octahedron
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer, samples_per_visibility_buffer
from ism_addon.sampling.pixel_grid import pixel_grid
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

#: Pixels whose centre lies on an edge more exactly than float32 can tell.
EDGE = 0.01

SHEAR = np.array([[1.0, 0.7, 0.0], [0.0, 0.6, 0.3], [0.2, 0.0, 1.4]])
MIRROR = np.diag([-1.0, 1.0, 0.5])


@pytest.fixture(params=["nearness", "logarithm"])
def either(request):
    """A device, or one as on macOS, where depth is the logarithm of the distance."""
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
    """Targets by name, pixels in rows: (N,components)."""
    drawn = draw(device, scene, view)
    anchor = drawn.renderer.frame(scene, view, SMALL_SETTINGS, 0, drawn.profile).anchor
    found = {
        name: drawn.target(name).reshape(view.width * view.height, -1)
        for name in ("depth", "position", "normal", "base_color", "primitive")
    }
    found["world"] = found["position"][:, :3] + anchor
    found["smooth"] = directions_from_octahedron(found["normal"][:, :2])
    found["facet"] = directions_from_octahedron(found["normal"][:, 2:])
    return found


def compare(device, scene, view, within: float = 1e-4) -> None:
    """All that the G-buffer holds, but for pixels on edges; positions to `within` m."""
    ours, truth = gbuffer(device, scene, view), reference.surfaces(scene, view)
    smooth = reference.shading_normals(scene, truth)
    seen = ours["position"][:, 3] > 0.0
    assert seen.any()
    assert (ours["depth"][~seen] == np.float32(1e10)).all()
    same = (seen == truth.seen) & (~seen | (np.abs(ours["world"] - truth.position).max(1) < within))
    assert (~same).mean() <= EDGE
    both = seen & truth.seen & same
    assert ours["depth"][both, 0] == pytest.approx(truth.depth[both], rel=1e-4, abs=within)
    assert (np.abs(ours["facet"] - truth.facet)[both].max(1) > 2e-3).mean() <= EDGE
    assert (np.abs(ours["smooth"] - smooth)[both].max(1) > 5e-3).mean() <= EDGE


def objects(matrices=None, mesh_ids=None):
    """Rubble, a smooth ball, and a slanted floor."""
    meshes = [random_triangles(60), sphere((0.4, -0.3, 0.2), 0.7, 16, 8), quad((-2, -2, -1), (4, 0, 0), (0, 4, 0.5))]
    return make_scene(meshes, matrices=matrices, mesh_ids=mesh_ids)


@pytest.mark.parametrize(
    "position", [(3.0, -3.0, 2.0), (0.1, 0.2, 6.0), (-2.0, 0.5, -3.0)], ids=["front", "above", "below"]
)
def test_positions_normals_and_depths(either, position):
    compare(either, objects(), look_at(position, size=(64, 48)))


def test_orthographic(either):
    compare(either, objects(), view_from_above(4.0, (60, 40)))


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
    """Everything, the camera too, stands far away: what is seen stays the same, to a tenth of a millimetre."""
    far = np.array([offset, -offset, 0.5 * offset]) + (0.123, 0.456, 0.789)
    scene = objects([transform(offset=far)] * 3)
    view = look_at(far + (3.0, -3.0, 2.0), far, size=(48, 36))
    compare(device, scene, view)


def test_a_mesh_far_from_its_own_origin(device):
    """Object coordinates of a thousand, brought back by the instance's matrix: they keep their float32 digits."""
    floor = quad((1000.0, 1000.0, 0.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.3))
    scene = make_scene([floor], matrices=[transform(offset=(-1001.0, -1001.0, 0.0))])
    compare(device, scene, look_at((1.0, -3.0, 2.0), size=(48, 36)))


def test_two_triangles_of_which_the_nearer_wins(either):
    """A millimetre apart at ten metres."""
    near, far = quad((-1, -1, 1e-3), (2, 0, 0), (0, 2, 0)), quad((-1, -1, 0), (2, 0, 0), (0, 2, 0))
    for order in ([near, far], [far, near]):
        ours = gbuffer(either, make_scene(order), view_from_above(1.0, (16, 16)))
        assert ours["world"][:, 2] == pytest.approx(1e-3, abs=2e-4)


@pytest.mark.parametrize("distance", [10.0, 100.0, 500.0])
def test_what_lies_a_little_behind_stays_hidden_though_the_near_plane_is_close(either, distance):
    """Blender's viewports begin 1 cm before the eye and end at 1 km."""
    apart, wide = 1e-4 * distance, 2.0 * distance
    near, far = (quad((-0.5 * wide, -0.5 * wide, z), (wide, 0, 0), (0, wide, 0)) for z in (apart, 0.0))
    view = look_at((0.0, -0.6 * distance, 0.8 * distance))
    view = replace(view, clip_from_view=perspective(math.radians(50.0), 32 / 24, 0.01, 1000.0))
    for order in ([near, far], [far, near]):
        ours = gbuffer(either, make_scene(order), view)
        assert ours["world"][:, 2] == pytest.approx(apart, abs=0.2 * apart)


def test_what_is_invisible_is_not_drawn(either):
    scene = objects()
    hidden = replace(scene, instances=replace(scene.instances, visible=np.array([True, False, True])))
    compare(either, hidden, look_at((3.0, -3.0, 2.0), size=(48, 36)))


def test_the_same_pixels_at_any_size_of_picture(device):
    """A picture of odd sizes, down to one pixel."""
    for size in ((1, 1), (1, 9), (33, 1), (17, 31)):
        compare(device, objects(), look_at((3.0, -3.0, 2.0), size=size))


def test_no_triangles_at_all(device):
    ours = gbuffer(device, make_scene([]), look_at((3.0, -3.0, 2.0)))
    assert not ours["position"].any()
    assert (ours["depth"] == np.float32(1e10)).all()


@pytest.mark.parametrize("samples", [3, 4, 16], ids=["a grid each", "four share one", "sixteen share one"])
def test_the_sample_moves_the_pixels_centres(device, samples):
    """The second and the last sample see what rays through their own subpixel offsets meet, however fine the grid."""
    view = replace(look_at((3.0, -3.0, 2.0), size=(48, 36)), filter_width=1.5)
    settings = with_quality(SMALL_SHADOW_MAPS, samples=samples)
    for newest in {1, samples - 1}:
        drawn = draw(device, objects(), view, settings, last=newest)
        count = samples_per_visibility_buffer(view, samples, device.texture_size)
        offset = pixel_grid(newest // count, count).subpixel_offsets[newest % count]
        shift = np.eye(4)
        shift[:2, 3] = -2.0 * offset / (48, 36)
        moved = replace(view, clip_from_view=shift @ view.clip_from_view)
        truth = reference.surfaces(objects(), moved)
        off = np.abs(drawn.target("depth").reshape(-1) - np.where(truth.seen, truth.depth, np.float32(1e10)))
        assert offset.any()
        assert (off > 1e-3).mean() <= EDGE


def test_a_hurried_first_sample_is_drawn_for_itself_and_the_picture_is_the_same(device):
    """Else the first one shares a drawing of the triangles with those that follow."""
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
    every = scene.triangle_count
    assert drawn == {True: [every, every, 0, 0], False: [every, 0, 0, 0]}
    assert np.abs(pictures[True] - pictures[False]).mean() < 1e-3 * pictures[True].mean()


@pytest.mark.parametrize(("beyond", "drawn"), [(-0.5, 2), (0.5, 2), (1.5, 0)])
def test_meshes_are_drawn_up_to_a_pixel_beyond_the_picture(device, beyond, drawn):
    """So far the graphics card's rounding may be off what is culled in double precision."""
    plate = quad((1.0 + beyond / 16.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    found = draw(device, make_scene([plate], world=1.0), view_from_above(2.0, (32, 32)))
    assert found.profile.counts["triangles_drawn"] == drawn
