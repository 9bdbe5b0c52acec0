# SPDX-License-Identifier: GPL-3.0-or-later
"""One 3D viewport: asks the worker for pictures, shows the latest, and never waits for one."""

from weakref import WeakSet, finalize

import bpy

from ..gpu.worker import Job, Picture, Request, shared
from ..scene import Scene, View
from . import account, camera, controls, extract
from .present import Presenter

LOOK_EVERY = 0.04  # s: how long a new picture can go unnoticed

#: The pixels of the first picture after a change are as coarse as it takes for it to come after about so long. s
FIRST = 0.1
#: Widths of those pixels.
COARSEST = 8

#: A viewport's switches for kinds of objects.
KINDS = [name for name in bpy.types.SpaceView3D.bl_rna.properties.keys() if name.startswith("show_object_viewport_")]  # noqa: SIM118

_alive: "WeakSet[Viewport]" = WeakSet()


class Viewport:
    """What is remembered between two redraws: copies only, nothing of bpy."""

    def __init__(self) -> None:
        self._client = object()
        self._reader = extract.Reader()
        self._scene: Scene | None = None
        self._shows: tuple | None = None
        self._coarse = COARSEST // 2
        self._asked: tuple | None = None
        self._job: Job | None = None
        self._picture: Picture | None = None
        self._told: tuple | None = None
        self._presenter = Presenter()
        _alive.add(self)
        # It dies with its engine, in whose own __del__ Blender has already taken everything away.
        finalize(self, shared.forget, self._client).atexit = False

    def update(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """The scene has changed, or what the viewport shows of it."""
        space = context.space_data
        shows = _shows(space)
        whole, self._shows = shows != self._shows, shows
        self._scene = self._reader.read(depsgraph, lambda thing: thing.visible_in_viewport_get(space), whole)

    def draw(self, engine: bpy.types.RenderEngine, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        """Show the latest picture, and ask for others if what it should show has changed."""
        if self._scene is None or self._shows != _shows(context.space_data):
            self.update(context, depsgraph)
        try:
            pixel = engine.get_preview_pixel_size(context.scene) * controls.pixel_size(context.scene)
            view = seen(context, depsgraph, pixel)
        except camera.CameraError as error:
            engine.update_stats("", str(error))
            return
        self._ask(view, context.scene)
        self._told = self._news()
        self._picture = self._job.picture() or self._picture
        if self._picture is not None:
            region = context.region
            self._presenter.draw(engine, context.scene, self._picture.color, region.width, region.height)
        shown = self._picture.samples if self._picture is self._job.picture() and self._picture else 0
        engine.update_stats("", self._job.error or f"Sample {shown}/{self._job.samples}")
        if not self._job.finished and not bpy.app.timers.is_registered(_look):
            bpy.app.timers.register(_look, first_interval=LOOK_EVERY)

    @property
    def has_news(self) -> bool:
        return self._job is not None and self._told != self._news()

    @property
    def statistics(self) -> dict:
        return self._job.statistics

    @property
    def is_waiting(self) -> bool:
        return self._job is not None and not self._job.finished

    def _ask(self, view: View, scene: bpy.types.Scene) -> None:
        chosen = controls.read(scene, "viewport")
        asked = (self._scene, _fingerprint(view), chosen, shared.edition)
        if asked != self._asked:
            if self._job is not None and self._job.first_seconds:
                self._coarse = coarser(self._coarse, self._job.first_seconds)
            request = Request(self._scene, view, chosen, surfaces=False, coarse=self._coarse)
            self._job = shared.start(request, self._client)
            self._asked = asked

    def _news(self) -> tuple:
        """What is worth a redraw, which costs Blender more than us: not each sample, but each picture."""
        return self._job, self._job.picture(), self._job.finished


def coarser(pixel: int, seconds: float) -> int:
    """The width of a first picture's pixels when one of width `pixel` took so long to draw."""
    if seconds > 1.5 * FIRST:
        return min(2 * pixel, COARSEST)
    # Halved, they are four times as many: time enough is left if it is well below.
    return max(pixel // 2, 1) if seconds < FIRST / 5.0 else pixel


def seen(context: bpy.types.Context, depsgraph: bpy.types.Depsgraph, pixel: int) -> View:
    """What the context's 3D viewport shows, each pixel that is drawn being `pixel` of its own wide and high."""
    region, space, scene = context.region, context.space_data, context.scene
    seen_through = space.camera if space.use_local_camera else scene.camera
    return camera.viewport_view(
        depsgraph, context.region_data, max(1, region.width // pixel), max(1, region.height // pixel), seen_through
    )


def _shows(space: bpy.types.SpaceView3D) -> tuple:
    """What kinds of objects a viewport shows, and whether it has chosen some: no depsgraph tells of a change."""
    return space.local_view is not None, space.use_local_collections, *(getattr(space, name) for name in KINDS)


def _fingerprint(view: View) -> tuple:
    matrices = view.clip_from_view.tobytes(), view.view_from_world.tobytes()
    return *matrices, view.width, view.height, view.filter_width, view.transparent


def _look() -> float | None:
    """Timer: redraw the viewports while one of them has something new to show, and at the end what it took."""
    news = [viewport for viewport in _alive if viewport.has_news]
    for viewport in news:
        account.keep("viewport", viewport.statistics)
    if news:
        redraw(also_properties=not any(viewport.is_waiting for viewport in _alive))
    return LOOK_EVERY if any(viewport.is_waiting or viewport.has_news for viewport in _alive) else None


def redraw(also_properties: bool = False) -> None:
    """Draw all viewports in Rendered shading again, and perhaps the properties, whose statistics they are."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            rendered = area.type == "VIEW_3D" and area.spaces.active.shading.type == "RENDERED"
            if rendered or (also_properties and area.type == "PROPERTIES"):
                area.tag_redraw()


def stop_looking() -> None:
    """End the timer."""
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
