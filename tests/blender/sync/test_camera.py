# SPDX-License-Identifier: GPL-3.0-or-later
"""Views, compared with Blender's own projection of points into the picture."""

import math

import bpy
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Matrix, Vector

from ism_addon.blender.sync import camera as cameras

POINTS = [(0, 0, 0), (1, 0.5, 0), (-2, 1, 3), (0.25, -0.5, -4)]


@pytest.fixture
def camera(add, empty_scene):
    """A tilted camera 10 m away from the origin, in a picture of 40 × 30 pixels."""
    thing = add("Camera", bpy.data.cameras.new("Camera"))
    thing.matrix_world = Matrix.Rotation(0.3, 4, "Z") @ Matrix.Rotation(0.2, 4, "X") @ Matrix.Translation((0, 0, 10))
    empty_scene.camera = thing
    empty_scene.render.resolution_x, empty_scene.render.resolution_y = 40, 30
    return thing


def final_view():
    return cameras.final_view(bpy.context.evaluated_depsgraph_get())


def projected(view, point):
    """The projection of a world point, in fractions of the picture from its bottom left."""
    clip = view.clip_from_view @ view.view_from_world @ np.append(point, 1.0)
    return clip[:2] / clip[3] / 2 + 0.5


def assert_projects_as_blender(view, scene, thing):
    for point in POINTS:
        expected = world_to_camera_view(scene, thing, Vector(point))
        assert np.allclose(projected(view, point), expected[:2], atol=2e-5)


@pytest.mark.parametrize(
    "properties",
    [
        {},
        {"lens": 20.0},
        {"shift_x": 0.3, "shift_y": -0.2},
        {"sensor_fit": "VERTICAL", "sensor_height": 30.0, "shift_x": 0.1},
        {"sensor_fit": "HORIZONTAL", "sensor_width": 20.0},
        {"type": "ORTHO", "ortho_scale": 5.0, "shift_x": -0.25},
    ],
)
@pytest.mark.parametrize(("width", "height"), [(40, 30), (30, 40)])
def test_a_point_is_projected_as_by_blender(camera, empty_scene, properties, width, height):
    empty_scene.render.resolution_x, empty_scene.render.resolution_y = width, height
    for name, value in properties.items():
        setattr(camera.data, name, value)
    view = final_view()
    assert (view.width, view.height) == (width, height)
    assert_projects_as_blender(view, empty_scene, camera)


def test_pixel_aspect(camera, empty_scene):
    empty_scene.render.pixel_aspect_x = 2.0
    assert_projects_as_blender(final_view(), empty_scene, camera)


def test_the_near_and_far_planes_are_the_cameras_clip(camera):
    camera.data.clip_start, camera.data.clip_end = 0.5, 20.0
    view = final_view()
    for distance, depth in ((0.5, -1.0), (20.0, 1.0)):
        clip = view.clip_from_view @ (0, 0, -distance, 1)
        assert clip[2] / clip[3] == pytest.approx(depth, abs=1e-5)


def test_the_cameras_scale_and_shear_change_nothing(camera):
    before = final_view()
    camera.scale = (2, 3, 0.5)
    after = final_view()
    assert np.allclose(after.view_from_world, before.view_from_world, atol=1e-5)
    rotation = after.view_from_world[:3, :3]
    assert np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert after.view_from_world.dtype == np.float64


def test_percentage_filter_and_film(camera, empty_scene):
    render = empty_scene.render
    render.resolution_percentage, render.filter_size, render.film_transparent = 55, 2.5, True
    view = final_view()
    assert (view.width, view.height, view.filter_width, view.transparent) == (22, 16, 2.5, True)


@pytest.mark.parametrize("corners", [(0.25, 0.75, 0.5, 1.0), (0.111, 0.532, 0.27, 0.91), (0.0, 1.0, 0.0, 1.0)])
def test_a_border_is_a_region_of_the_full_picture(camera, empty_scene, corners):
    render = empty_scene.render
    full = final_view()
    render.use_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = corners
    region = final_view()
    left, _, bottom, _ = cameras.border(render)
    for point in POINTS:
        pixel = projected(full, point) * (full.width, full.height)
        assert np.allclose(projected(region, point) * (region.width, region.height) + (left, bottom), pixel, atol=1e-9)


def test_a_border_has_as_many_pixels_as_in_blender(camera, empty_scene, call_in_render):
    render = empty_scene.render
    empty_scene.camera = camera
    render.resolution_x, render.resolution_y, render.use_border = 333, 77, True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.117, 0.773, 0.291, 0.684

    def read_sizes(engine, depsgraph):
        view = cameras.final_view(depsgraph, engine)
        result = engine.begin_result(0, 0, 9999, 9999)  # Blender clips this to the size of the render
        blender_size = (result.resolution_x, result.resolution_y)
        engine.end_result(result, cancel=True)
        return (view.width, view.height), blender_size

    ((our_size, blender_size),) = call_in_render(read_sizes)
    assert our_size == blender_size


def test_the_engines_view_is_the_cameras(camera, empty_scene, call_in_render):
    empty_scene.camera = camera
    (view,) = call_in_render(lambda engine, depsgraph: cameras.final_view(depsgraph, engine))
    empty_scene.camera = camera
    assert_projects_as_blender(view, empty_scene, empty_scene.camera)


@pytest.mark.parametrize("shift", [0.0, 0.2])
def test_both_eyes_project_the_convergence_plane_alike(camera, empty_scene, call_in_render, shift):
    render = empty_scene.render
    render.use_multiview = True
    stereo = camera.data.stereo
    stereo.convergence_distance, stereo.interocular_distance, camera.data.shift_x = 4.0, 0.5, shift

    def read_views(engine, depsgraph):
        views = []
        for eye in ("left", "right"):
            engine.active_view_set(eye)
            views.append(cameras.final_view(depsgraph, engine))
        return views

    empty_scene.camera = camera
    results = call_in_render(read_views)
    empty_scene.camera = camera
    left, right = results[0]
    assert np.linalg.norm(left.view_from_world[:3, 3] - right.view_from_world[:3, 3]) == pytest.approx(0.5, abs=1e-5)
    for x in (-1, 0, 1):
        point = camera.matrix_world @ Vector((x, 0, -4))
        expected = world_to_camera_view(empty_scene, camera, point)[:2]
        assert np.allclose(projected(left, point), expected, atol=1e-5)
        assert np.allclose(projected(right, point), expected, atol=1e-5)


def test_a_panoramic_camera_is_refused_in_one_sentence(camera):
    camera.data.type = "PANO"
    with pytest.raises(cameras.CameraError, match=r"The camera 'Camera' is panoramic, which this engine cannot draw; "):
        final_view()


def test_a_camera_whose_clip_ends_before_it_starts_is_refused(camera):
    camera.data.clip_start, camera.data.clip_end = 5.0, 2.0
    with pytest.raises(cameras.CameraError, match="sees nothing: its clip ends before it starts"):
        final_view()


def test_a_missing_camera_and_an_object_that_is_no_camera_are_refused(add, empty_scene):
    with pytest.raises(cameras.CameraError, match="no active camera"):
        final_view()
    empty_scene.camera = add("Square")
    with pytest.raises(cameras.CameraError, match="'Square' is no camera"):
        final_view()


@pytest.mark.parametrize("scale", [(0, 1, 1), (0, 0, 0), (math.nan, 1, 1), (math.inf, 1, 1)])
def test_a_camera_that_is_scaled_to_nothing_is_refused(camera, scale):
    camera.scale = scale
    with pytest.raises(cameras.CameraError, match="'Camera' is too far away or scaled to nothing"):
        final_view()


def viewport_space():
    """The first 3D viewport of Blender's startup file."""
    areas = (area for screen in bpy.data.screens for area in screen.areas if area.type == "VIEW_3D")
    return next(areas).spaces[0]


def viewport(perspective="PERSP"):
    """Its region_3d, which looks at the scene from a fixed position."""
    region = viewport_space().region_3d
    region.view_matrix = Matrix.Rotation(0.4, 4, "X") @ Matrix.Translation((1, 2, -10))
    region.view_perspective = perspective
    return region


def test_a_viewports_view_is_its_matrices(empty_scene):
    region = viewport()
    view = cameras.viewport_view(bpy.context.evaluated_depsgraph_get(), region, 64, 48)
    assert (view.width, view.height) == (64, 48)
    assert np.allclose(view.view_from_world, np.array(region.view_matrix), atol=1e-6)
    assert np.array_equal(view.clip_from_view, np.array(region.window_matrix))


def test_a_viewport_refuses_a_panoramic_camera_only_when_it_looks_through_it(camera):
    camera.data.type = "PANO"
    depsgraph = bpy.context.evaluated_depsgraph_get()
    cameras.viewport_view(depsgraph, viewport("PERSP"), 64, 48, camera)
    with pytest.raises(cameras.CameraError):
        cameras.viewport_view(depsgraph, viewport("CAMERA"), 64, 48, camera)


@pytest.mark.parametrize(
    ("border", "part"),
    [
        ((0.25, 0.5, 0.25, 0.75), (16, 32, 12, 36)),
        ((0.0, 1.0, 0.0, 1.0), (0, 64, 0, 48)),
        ((0.5, 0.5, 1.0, 1.0), (32, 33, 47, 48)),
    ],
)
def test_a_viewports_render_region_is_a_rectangle_of_its_pixels(empty_scene, border, part):
    space, depsgraph = viewport_space(), bpy.context.evaluated_depsgraph_get()
    region = space.region_3d
    space.use_render_border = False
    assert cameras.render_region(depsgraph, space, region, 64, 48, None) == (0, 64, 0, 48)
    space.use_render_border = True
    for name, value in zip(("min_x", "max_x", "min_y", "max_y"), border, strict=True):
        setattr(space, f"render_border_{name}", value)
    assert cameras.render_region(depsgraph, space, region, 64, 48, None) == part


def test_a_cropped_viewport_projects_as_the_full_one(empty_scene):
    region, depsgraph = viewport(), bpy.context.evaluated_depsgraph_get()
    full = cameras.viewport_view(depsgraph, region, 64, 48)
    cropped = cameras.viewport_view(depsgraph, region, 64, 48, crop=(16, 32, 12, 36))
    assert (cropped.width, cropped.height) == (16, 24)
    for point in POINTS:
        pixel = projected(full, point) * (64, 48)
        assert np.allclose(projected(cropped, point) * (16, 24) + (16, 12), pixel, atol=1e-6)
