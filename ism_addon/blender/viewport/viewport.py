# SPDX-License-Identifier: GPL-3.0-or-later
"""One 3D viewport: requests pictures from the render thread and shows the latest. It never waits."""

from collections.abc import Callable
from weakref import finalize

import bpy

from ...gpu.jobs.job import Job, Picture, Request
from ...gpu.jobs.render_thread import shared
from ...scene import Scene, View
from ...setting_limits import beyond_limits, images_beyond_limits, view_beyond_limits
from ...settings import Settings
from ..render import read_settings
from ..sync import camera, scene_reader
from . import redraw_timer
from .display import ImageDisplay, ViewportRect

#: Target time of the preview, the first picture after a change. Its pixels are enlarged to reach it. s
PREVIEW_SECONDS = 0.1
#: Largest width of a preview's pixels.
MAX_PREVIEW_PIXEL_SIZE = 8

#: Names of a viewport's switches for types of objects.
_SPACE_PROPERTIES = bpy.types.SpaceView3D.bl_rna.properties.keys()
TYPE_SWITCHES = [name for name in _SPACE_PROPERTIES if name.startswith("show_object_viewport_")]


class Viewport:
    """The state of a viewport between redraws: copies only, no references to bpy data."""

    def __init__(self) -> None:
        self._client = object()
        self._reader = scene_reader.Reader()
        self._scene: Scene | None = None
        self._shown_objects: tuple | None = None
        shared.expect()
        self._preview_pixel_size = MAX_PREVIEW_PIXEL_SIZE // 2
        self._requested: tuple | None = None
        self._is_pending = False  # the latest request waits until the job has a picture
        self._job: Job | None = None
        self._warnings: tuple[str, ...] = ()
        self._viewport_rect: ViewportRect = 0.0, 0.0, 0.0, 0.0  # of the job's pictures
        self._shown: tuple[Picture, ViewportRect] | None = None
        self._drawn_state: tuple | None = None
        self._display = ImageDisplay()
        redraw_timer.watch(self)
        # Not in the engine's __del__, where Blender has already freed its data.
        finalize(self, shared.forget, self._client).atexit = False

    def update(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> Scene:
        """Read the scene after a change of the scene, or of what the viewport shows."""
        space = context.space_data
        shown = _shown_objects(space)
        has_changed, self._shown_objects = shown != self._shown_objects, shown
        self._scene = self._reader.read(depsgraph, visibility_in(space), all_instances=has_changed)
        return self._scene

    def draw(self, engine: bpy.types.RenderEngine, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """Show the latest picture, and request others if the inputs have changed."""
        scene = self._scene
        if scene is None or self._shown_objects != _shown_objects(context.space_data):
            scene = self.update(context, depsgraph)
        try:
            view, rect = viewport_view(context, depsgraph)
        except camera.CameraError as error:
            engine.update_stats("", str(error))
            return
        job = self._request(scene, view, rect, read_settings.read(context.scene, "viewport"))
        self._drawn_state = self._state()
        self._show_picture()
        if self._shown is not None:
            picture, rect = self._shown
            self._display.draw(engine, context.scene, picture.color, rect)
        engine.update_stats("", job.error or " ".join([job.status, *self._warnings, *job.warnings]))
        if self.is_rendering or self.has_update:
            redraw_timer.start_timer()

    @property
    def has_update(self) -> bool:
        may_request = self._is_pending and not self._has_no_picture_yet
        return self._job is not None and (may_request or self._drawn_state != self._state())

    @property
    def statistics(self) -> dict:
        return self._job.statistics if self._job is not None else {}

    @property
    def is_rendering(self) -> bool:
        return self._job is not None and not self._job.finished

    def _request(self, scene: Scene, view: View, rect: ViewportRect, settings: Settings) -> Job:
        """The job for these inputs, started if they are new; the previous job if it has no picture yet."""
        requested = (scene, _fingerprint(view), rect, settings, shared.shader_version)
        self._is_pending = requested != self._requested and self._has_no_picture_yet
        if self._job is None or (requested != self._requested and not self._is_pending):
            if self._job is not None and self._job.first_seconds:
                self._preview_pixel_size = next_preview_pixel_size(self._preview_pixel_size, self._job.first_seconds)
                self._show_picture()
            request = Request(scene, view, settings, preview_pixel_size=self._preview_pixel_size)
            self._job = shared.start(request, self._client)
            self._requested, self._viewport_rect = requested, rect
            image_warnings = images_beyond_limits(scene.images)
            self._warnings = *image_warnings, *beyond_limits(settings), *view_beyond_limits(view)
        return self._job

    def _show_picture(self) -> None:
        """Take the job's latest picture, if it has one."""
        picture = self._picture
        if picture is not None:
            self._shown = picture, self._viewport_rect

    @property
    def _picture(self) -> Picture | None:
        """The job's latest picture."""
        return self._job.picture() if self._job is not None else None

    @property
    def _has_no_picture_yet(self) -> bool:
        """Whether even an outdated job continues to its first picture: otherwise a moving view would show none."""
        return self.is_rendering and self._picture is None

    def _state(self) -> tuple:
        """Unchanged while no redraw is needed: it changes with each picture, not with each sample."""
        programs = None if self._job is None else self._job.programs_shown
        return self._job, self._picture, self.is_rendering, programs


def next_preview_pixel_size(pixel: int, seconds: float) -> int:
    """The next preview's pixel size, if the last one had the size `pixel` and took `seconds`."""
    if seconds > 1.5 * PREVIEW_SECONDS:
        return min(2 * pixel, MAX_PREVIEW_PIXEL_SIZE)
    # Half the pixel size means four times as many pixels.
    return max(pixel // 2, 1) if seconds < PREVIEW_SECONDS / 5.0 else pixel


def viewport_view(context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> tuple[View, ViewportRect]:
    """The view of the context's 3D viewport, and its rectangle in the region."""
    pixel = read_settings.pixel_size(context.scene)
    region, space, data = context.region, context.space_data, context.region_data
    camera_object = space.camera if space.use_local_camera else context.scene.camera
    size = width, height = max(1, region.width // pixel), max(1, region.height // pixel)
    crop = left, right, bottom, top = camera.render_region(depsgraph, space, data, *size, camera_object)
    scale_x, scale_y = region.width / width, region.height / height
    rect = left * scale_x, bottom * scale_y, (right - left) * scale_x, (top - bottom) * scale_y
    return camera.viewport_view(depsgraph, data, *size, camera_object, crop), rect


def visibility_in(space: bpy.types.SpaceView3D) -> Callable[[bpy.types.Object], bool]:
    """A filter of a depsgraph's objects: those that the viewport shows."""
    return lambda source: source.visible_in_viewport_get(space)


def _shown_objects(space: bpy.types.SpaceView3D) -> tuple:
    """The viewport's settings of what it shows. The depsgraph does not report their changes."""
    return space.local_view is not None, space.use_local_collections, *(getattr(space, name) for name in TYPE_SWITCHES)


def _fingerprint(view: View) -> tuple:
    matrices = view.clip_from_view.tobytes(), view.view_from_world.tobytes()
    return *matrices, view.width, view.height, view.filter_width, view.transparent
