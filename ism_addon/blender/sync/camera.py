# SPDX-License-Identifier: GPL-3.0-or-later
"""The View of a final render or of a viewport, from Blender's projection matrices."""

import bpy
import numpy as np

from ...scene import View
from ...scene.limits import is_within

#: Left, right, bottom and top of a crop of the image, px.
Crop = tuple[int, int, int, int]

#: Types of camera that a projection matrix can describe.
DRAWABLE = ("PERSP", "ORTHO")


class CameraError(Exception):
    """The camera cannot be drawn. The message is one sentence for the artist."""


def final_view(depsgraph: bpy.types.Depsgraph, engine: bpy.types.RenderEngine | None = None) -> View:
    """The view of the scene's active camera, cropped to the render region, at the render's resolution percentage.

    `engine` gives the camera's matrix and shift for the current stereo view.
    Raises CameraError if there is no camera that can be drawn.
    """
    render = depsgraph.scene_eval.render
    camera = (engine and engine.camera_override) or depsgraph.scene_eval.camera
    if camera is None:
        raise CameraError("The scene has no active camera; add one, or make one active with Ctrl+Numpad 0.")
    _check(camera)
    camera = camera.evaluated_get(depsgraph)
    width, height = full_size(render)
    clip_from_view = camera.calc_matrix_camera(
        depsgraph, x=width, y=height, scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y
    )
    clip_from_view = np.array(clip_from_view, np.float64)
    world_from_view = np.array(camera.matrix_world, np.float64)
    if engine is not None:
        world_from_view = np.array(engine.camera_model_matrix(camera), np.float64).reshape(4, 4)
        shift = engine.camera_shift_x(camera) - camera.data.shift_x
        clip_from_view = _shifted(clip_from_view, shift * _shift_unit(camera.data, render, width, height))
    if not (is_within(world_from_view).all() and np.linalg.norm(world_from_view[:3, :3], axis=0).all()):
        raise CameraError(f"The camera '{camera.name}' is too far away or scaled to nothing; clear its transform.")
    left, right, bottom, top = border(render)
    return View.of(
        clip_from_view=_cropped(clip_from_view, left / width, right / width, bottom / height, top / height),
        view_from_world=_rigid_inverse(world_from_view),
        width=right - left,
        height=top - bottom,
        filter_width=render.filter_size,
        transparent=render.film_transparent,
    )


def viewport_view(
    depsgraph: bpy.types.Depsgraph,
    region_data: bpy.types.RegionView3D,
    width: int,
    height: int,
    camera: bpy.types.Object | None = None,
    crop: Crop | None = None,
) -> View:
    """The view of a 3D viewport of width × height pixels, or a crop of it; `camera`: the one that camera view uses.

    Raises CameraError if the viewport looks through a camera that cannot be drawn.
    """
    if region_data.view_perspective == "CAMERA" and camera is not None:
        _check(camera)
    render = depsgraph.scene_eval.render
    left, right, bottom, top = crop or (0, width, 0, height)
    clip_from_view = np.array(region_data.window_matrix, np.float64)
    return View.of(
        clip_from_view=_cropped(clip_from_view, left / width, right / width, bottom / height, top / height),
        view_from_world=_rigid_inverse(np.linalg.inv(np.array(region_data.view_matrix, np.float64))),
        width=right - left,
        height=top - bottom,
        filter_width=render.filter_size,
        transparent=render.film_transparent,
    )


def full_size(render: bpy.types.RenderSettings) -> tuple[int, int]:
    """Width and height of the image without cropping to the render region, px."""
    scale = render.resolution_percentage
    return max(render.resolution_x * scale // 100, 1), max(render.resolution_y * scale // 100, 1)


def border(render: bpy.types.RenderSettings) -> Crop:
    """The render region of a final render, or the full image."""
    width, height = full_size(render)
    if not render.use_border:
        return 0, width, 0, height
    x = np.array([render.border_min_x, render.border_max_x], np.float32)
    y = np.array([render.border_min_y, render.border_max_y], np.float32)
    return *_pixels(x, width), *_pixels(y, height)


def render_region(
    depsgraph: bpy.types.Depsgraph,
    space: bpy.types.SpaceView3D,
    region_data: bpy.types.RegionView3D,
    width: int,
    height: int,
    camera: bpy.types.Object | None,
) -> Crop:
    """The render region of a 3D viewport of width × height pixels (in camera view, the camera's), or all of it.

    It has at least one pixel, at the nearest side if the region is outside.
    """
    render = depsgraph.scene_eval.render
    if region_data.view_perspective == "CAMERA" and camera is not None:
        if not render.use_border:
            return 0, width, 0, height
        left, right, bottom, top = _frame(depsgraph, region_data, camera)
        x = left + (right - left) * np.array([render.border_min_x, render.border_max_x])
        y = bottom + (top - bottom) * np.array([render.border_min_y, render.border_max_y])
    elif space.use_render_border:
        x = np.array([space.render_border_min_x, space.render_border_max_x])
        y = np.array([space.render_border_min_y, space.render_border_max_y])
    else:
        return 0, width, 0, height
    return *_pixels(x, width), *_pixels(y, height)


def _pixels(ends: np.ndarray, count: int) -> tuple[int, int]:
    """The range of pixels [first, end) between two fractions of `count` pixels, rounded as Blender does."""
    first, end = (ends.clip(0, 1) * ends.dtype.type(count)).astype(int)
    first = min(int(first), count - 1)
    return first, max(int(end), first + 1)


def _frame(depsgraph: bpy.types.Depsgraph, region_data: bpy.types.RegionView3D, camera: bpy.types.Object) -> np.ndarray:
    """Left, right, bottom and top of the camera frame in camera view, as fractions of the viewport."""
    corners = camera.evaluated_get(depsgraph).data.view_frame(scene=depsgraph.scene_eval)
    points = np.array([(*corner, 1.0) for corner in corners]) @ np.array(region_data.window_matrix, np.float64).T
    fractions = points[:, :2] / points[:, 3:] / 2.0 + 0.5
    return np.array([fractions.min(0), fractions.max(0)]).T.reshape(-1)


def _check(camera: bpy.types.Object) -> None:
    if camera.type != "CAMERA":
        raise CameraError(f"The active camera '{camera.name}' is no camera; choose one to draw a picture.")
    if camera.data.type not in DRAWABLE:
        raise CameraError(
            f"The camera '{camera.name}' is panoramic, which this engine cannot draw; "
            "make it perspective or orthographic."
        )
    if camera.data.clip_start >= camera.data.clip_end:
        raise CameraError(f"The camera '{camera.name}' sees nothing: its clip ends before it starts.")


def _cropped(clip_from_view: np.ndarray, left: float, right: float, bottom: float, top: float) -> np.ndarray:
    """The projection of a crop, given in fractions of the image."""
    crop_from_image = np.eye(4)
    crop_from_image[0, 0], crop_from_image[0, 3] = 1 / (right - left), (1 - left - right) / (right - left)
    crop_from_image[1, 1], crop_from_image[1, 3] = 1 / (top - bottom), (1 - bottom - top) / (top - bottom)
    return crop_from_image @ clip_from_view


def _shifted(clip_from_view: np.ndarray, fraction: float) -> np.ndarray:
    """The projection of a frame moved to the right by a fraction of its width."""
    return _cropped(clip_from_view, fraction, 1 + fraction, 0, 1)


def _shift_unit(camera: bpy.types.Camera, render: bpy.types.RenderSettings, width: int, height: int) -> float:
    """Blender's unit of camera shift, the side that the sensor is fitted to, relative to the image's width."""
    pixel_height = render.pixel_aspect_y / render.pixel_aspect_x
    is_landscape = width >= height * pixel_height
    fits_width = camera.sensor_fit == "HORIZONTAL" or (camera.sensor_fit == "AUTO" and is_landscape)
    return 1.0 if fits_width else height * pixel_height / width


def _rigid_inverse(world_from_view: np.ndarray) -> np.ndarray:
    """view_from_world of a camera's matrix, without scale and shear, which Blender's renders ignore."""
    rotation = world_from_view[:3, :3] / np.linalg.norm(world_from_view[:3, :3], axis=0)
    u, _, v = np.linalg.svd(rotation)
    rotation = u @ v
    view_from_world = np.eye(4)
    view_from_world[:3, :3] = rotation.T
    view_from_world[:3, 3] = -rotation.T @ world_from_view[:3, 3]
    return view_from_world
