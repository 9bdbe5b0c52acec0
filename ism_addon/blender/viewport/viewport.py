# SPDX-License-Identifier: GPL-3.0-or-later
"""One 3D viewport: asks the worker for pictures, shows the latest, and never waits for one."""

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

#: The pixels of the first picture after a change are as coarse as it takes for it to come after about so long. s
FIRST = 0.1
#: Widths of those pixels.
COARSEST = 8

#: A viewport's switches for kinds of objects.
KINDS = [name for name in bpy.types.SpaceView3D.bl_rna.properties.keys() if name.startswith("show_object_viewport_")]  # noqa: SIM118


class Viewport:
    """What is remembered between two redraws: copies only, nothing of bpy."""

    def __init__(self) -> None:
        self._client = object()
        self._reader = scene_reader.Reader()
        self._scene: Scene | None = None
        self._shows: tuple | None = None
        shared.expect()
        self._coarse = COARSEST // 2
        self._asked: tuple | None = None
        self._late = False  # what it should show is still to be asked for
        self._job: Job | None = None
        self._warnings: tuple[str, ...] = ()
        self._place: ViewportRect = 0.0, 0.0, 0.0, 0.0  # in the region, of the job's pictures
        self._shown: tuple[Picture, ViewportRect] | None = None
        self._told: tuple | None = None
        self._presenter = ImageDisplay()
        redraw_timer.watch(self)
        # It dies with its engine, in whose own __del__ Blender has already taken everything away.
        finalize(self, shared.forget, self._client).atexit = False

    def update(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> Scene:
        """The scene has changed, or what the viewport shows of it."""
        space = context.space_data
        shows = _shows(space)
        whole, self._shows = shows != self._shows, shows
        self._scene = self._reader.read(depsgraph, shown_by(space), whole)
        return self._scene

    def draw(self, engine: bpy.types.RenderEngine, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """Show the latest picture, and ask for others if what it should show has changed."""
        scene = self._scene
        if scene is None or self._shows != _shows(context.space_data):
            scene = self.update(context, depsgraph)
        try:
            view, place = seen(context, depsgraph)
        except camera.CameraError as error:
            engine.update_stats("", str(error))
            return
        job = self._ask(scene, view, place, read_settings.read(context.scene, "viewport"))
        self._told = self._news()
        self._look_at_job()
        if self._shown is not None:
            picture, place = self._shown
            self._presenter.draw(engine, context.scene, picture.color, place)
        engine.update_stats("", job.error or " ".join([job.status, *self._warnings]))
        if self.is_waiting or self.has_news:
            redraw_timer.start_timer()

    @property
    def has_news(self) -> bool:
        may_ask = self._late and not self._nothing_to_show_yet
        return self._job is not None and (may_ask or self._told != self._news())

    @property
    def statistics(self) -> dict:
        return self._job.statistics if self._job is not None else {}

    @property
    def is_waiting(self) -> bool:
        return self._job is not None and not self._job.finished

    def _ask(self, scene: Scene, view: View, place: ViewportRect, chosen: Settings) -> Job:
        """The job whose pictures are to be shown now."""
        asked = (scene, _fingerprint(view), place, chosen, shared.shader_version)
        self._late = asked != self._asked and self._nothing_to_show_yet
        if self._job is None or (asked != self._asked and not self._late):
            if self._job is not None and self._job.first_seconds:
                self._coarse = next_preview_size(self._coarse, self._job.first_seconds)
                self._look_at_job()
            request = Request(scene, view, chosen, preview_pixel_size=self._coarse)
            self._job = shared.start(request, self._client)
            self._asked, self._place = asked, place
            of_images = images_beyond_limits(scene.images)
            self._warnings = *of_images, *beyond_limits(chosen), *view_beyond_limits(view)
        return self._job

    def _look_at_job(self) -> None:
        """Show its picture, if it has one by now."""
        picture = self._picture
        if picture is not None:
            self._shown = picture, self._place

    @property
    def _picture(self) -> Picture | None:
        """The job's latest."""
        return self._job.picture() if self._job is not None else None

    @property
    def _nothing_to_show_yet(self) -> bool:
        """Whether the job has to go on to its first picture, though outdated: a view that turns would have none."""
        return self.is_waiting and self._picture is None

    def _news(self) -> tuple:
        """What is worth a redraw, which costs Blender more than us: not each sample, but each picture."""
        programs = None if self._job is None else self._job.programs_shown
        return self._job, self._picture, self.is_waiting, programs


def next_preview_size(pixel: int, seconds: float) -> int:
    """The width of a first picture's pixels when one of width `pixel` took so long to draw."""
    if seconds > 1.5 * FIRST:
        return min(2 * pixel, COARSEST)
    # Halved, they are four times as many: time enough is left if it is well below.
    return max(pixel // 2, 1) if seconds < FIRST / 5.0 else pixel


def seen(context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> tuple[View, ViewportRect]:
    """What the context's 3D viewport shows, and where in it."""
    pixel = read_settings.pixel_size(context.scene)
    region, space, data = context.region, context.space_data, context.region_data
    seen_through = space.camera if space.use_local_camera else context.scene.camera
    size = width, height = max(1, region.width // pixel), max(1, region.height // pixel)
    part = left, right, bottom, top = camera.render_region(depsgraph, space, data, *size, seen_through)
    across, up = region.width / width, region.height / height
    place = left * across, bottom * up, (right - left) * across, (top - bottom) * up
    return camera.viewport_view(depsgraph, data, *size, seen_through, part), place


def shown_by(space: bpy.types.SpaceView3D) -> Callable[[bpy.types.Object], bool]:
    """Whether a viewport shows an object, of those that its depsgraph has."""
    return lambda thing: thing.visible_in_viewport_get(space)


def _shows(space: bpy.types.SpaceView3D) -> tuple:
    """What kinds of objects a viewport shows, and whether it has chosen some: no depsgraph tells of a change."""
    return space.local_view is not None, space.use_local_collections, *(getattr(space, name) for name in KINDS)


def _fingerprint(view: View) -> tuple:
    matrices = view.clip_from_view.tobytes(), view.view_from_world.tobytes()
    return *matrices, view.width, view.height, view.filter_width, view.transparent
