# SPDX-License-Identifier: GPL-3.0-or-later
"""The final render's and the viewport's View, from Blender's own projection matrices."""

import bpy
import numpy as np

from ...scene import View
from ...scene.limits import is_within

#: Left, right, bottom and top of a part of a picture, in pixels of the whole.
Part = tuple[int, int, int, int]

#: The types of camera whose picture a matrix can describe.
DRAWABLE = ("PERSP", "ORTHO")


class CameraError(Exception):
    """No picture can be taken: the message is one sentence for the artist."""


def final_view(depsgraph: bpy.types.Depsgraph, engine: bpy.types.RenderEngine | None = None) -> View:
    """What the scene's active camera sees of the picture's border region, at the render's percentage.

    The engine, where there is one, knows the stereo view that is being rendered and its camera's place.
    Raises CameraError without a camera that can be drawn.
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
    part: Part | None = None,
) -> View:
    """What a 3D viewport of width × height pixels shows, or a part of it; the camera is what it may look through.

    Raises CameraError if the viewport looks through a camera that cannot be drawn.
    """
    if region_data.view_perspective == "CAMERA" and camera is not None:
        _check(camera)
    render = depsgraph.scene_eval.render
    left, right, bottom, top = part or (0, width, 0, height)
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
    """Pixels of the whole picture, before the border cuts out its part."""
    scale = render.resolution_percentage
    return max(render.resolution_x * scale // 100, 1), max(render.resolution_y * scale // 100, 1)


def border(render: bpy.types.RenderSettings) -> Part:
    """What of the whole picture is rendered."""
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
) -> Part:
    """What of a 3D viewport of width × height pixels is drawn: its render region, or in the camera's view the camera's.

    One pixel at least, at the side where the rest of it would be.
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
    """The first of `count` pixels and the one after the last between two fractions; rounded as Blender does."""
    first, end = (ends.clip(0, 1) * ends.dtype.type(count)).astype(int)
    first = min(int(first), count - 1)
    return first, max(int(end), first + 1)


def _frame(depsgraph: bpy.types.Depsgraph, region_data: bpy.types.RegionView3D, camera: bpy.types.Object) -> np.ndarray:
    """Left, right, bottom and top of the camera's frame in a viewport that looks through it, as fractions of that."""
    corners = camera.evaluated_get(depsgraph).data.view_frame(scene=depsgraph.scene_eval)
    points = np.array([(*corner, 1.0) for corner in corners]) @ np.array(region_data.window_matrix, np.float64).T
    places = points[:, :2] / points[:, 3:] / 2.0 + 0.5
    return np.array([places.min(0), places.max(0)]).T.reshape(-1)


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
    """The projection onto a part of the picture, given in fractions of it."""
    part_from_whole = np.eye(4)
    part_from_whole[0, 0], part_from_whole[0, 3] = 1 / (right - left), (1 - left - right) / (right - left)
    part_from_whole[1, 1], part_from_whole[1, 3] = 1 / (top - bottom), (1 - bottom - top) / (top - bottom)
    return part_from_whole @ clip_from_view


def _shifted(clip_from_view: np.ndarray, fraction: float) -> np.ndarray:
    """The projection of a frame moved to the right by a fraction of its width."""
    return _cropped(clip_from_view, fraction, 1 + fraction, 0, 1)


def _shift_unit(camera: bpy.types.Camera, render: bpy.types.RenderSettings, width: int, height: int) -> float:
    """Blender's unit of shift, the side that the sensor is fitted to, in widths of the picture."""
    pixel_height = render.pixel_aspect_y / render.pixel_aspect_x
    wide = width >= height * pixel_height
    horizontal = camera.sensor_fit == "HORIZONTAL" or (camera.sensor_fit == "AUTO" and wide)
    return 1.0 if horizontal else height * pixel_height / width


def _rigid_inverse(world_from_view: np.ndarray) -> np.ndarray:
    """View from world of a camera's matrix without its scale and shear, as Blender's renders leave them out."""
    rotation = world_from_view[:3, :3] / np.linalg.norm(world_from_view[:3, :3], axis=0)
    u, _, v = np.linalg.svd(rotation)
    rotation = u @ v
    view_from_world = np.eye(4)
    view_from_world[:3, :3] = rotation.T
    view_from_world[:3, 3] = -rotation.T @ world_from_view[:3, 3]
    return view_from_world
