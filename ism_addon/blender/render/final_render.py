# SPDX-License-Identifier: GPL-3.0-or-later
"""The final render of one view layer: renders each stereo view into Blender's passes."""

import math
import time
from collections.abc import Callable, Iterator

import bpy

from ...gpu.jobs.job import Job, Picture, Request
from ...gpu.jobs.render_thread import shared
from ...render_passes import enabled
from ...scene import View
from ...setting_limits import beyond_limits, images_beyond_limits, view_beyond_limits
from ..sync import camera
from . import persistent_data, read_settings, render_statistics

WAIT_SECONDS = 0.1  # between checks for Escape
UPDATE_INTERVAL = 1.0  # s between intermediate pictures, each a copy and a redraw

#: The estimated error, relative to the mean luminance, from which a finished picture is said to be noisy.
NOISY = 0.05


def render(engine: bpy.types.RenderEngine, depsgraph: bpy.types.Depsgraph) -> None:
    """Render the depsgraph's view layer. Errors are reported by the engine, a sentence each."""
    layer = depsgraph.view_layer_eval
    cache = persistent_data.LayerCache() if engine.is_preview else persistent_data.layer_cache(depsgraph)
    view_names = _view_names(engine, layer.name)
    shared.expect()
    try:
        scene = cache.read(depsgraph, _all_until_break(engine))
    except _Cancelled:
        cache.reader.invalidate()  # the depsgraph reports each update once
        for view_name in view_names:  # one black pixel: without a result, Blender would crash when it saves
            engine.end_result(engine.begin_result(0, 0, 1, 1, layer=layer.name, view=view_name))
        return
    settings = read_settings.read(depsgraph.scene_eval, "viewport" if engine.is_preview else "render")
    if not engine.is_preview:
        for warning in (*scene.warnings, *images_beyond_limits(scene.images), *beyond_limits(settings)):
            engine.report({"WARNING"}, warning)
    passes = enabled(layer)
    try:
        for view_name in view_names:
            engine.active_view_set(view_name)
            view = camera.final_view(depsgraph, engine)
            if view_name == view_names[0] and not engine.is_preview:
                for warning in view_beyond_limits(view):
                    engine.report({"WARNING"}, warning)
            job = shared.start(Request(scene, view, settings, passes), cache.client)
            if not _render_view(engine, job, view, layer.name, view_name):
                break
    except camera.CameraError as error:
        _report_error(engine, str(error))
    finally:
        if engine.is_preview:
            shared.forget(cache.client)


class _Cancelled(Exception):
    """The user has pressed Escape while the scene is read."""


def _all_until_break(engine: bpy.types.RenderEngine) -> Callable[[bpy.types.Object], bool]:
    """A filter that accepts all objects. It is called before each is read, and raises _Cancelled after Escape."""

    def is_shown(_object: bpy.types.Object) -> bool:
        if engine.test_break():
            raise _Cancelled
        return True

    return is_shown


def _view_names(engine: bpy.types.RenderEngine, layer: str) -> list[str]:
    """Names of the stereo views, which only a render result has. Without stereo, one empty name."""
    result = engine.begin_result(0, 0, 1, 1, layer=layer)
    names = [view.name for view in result.views]
    engine.end_result(result, cancel=True)
    return names


def _render_view(engine: bpy.types.RenderEngine, job: Job, view: View, layer: str, view_name: str) -> bool:
    """Wait until a job is done, cancelled or failed, and store its latest picture. True if it is done."""
    result = engine.begin_result(0, 0, view.width, view.height, layer=layer, view=view_name)
    passes = result.layers[0].passes
    shown: Picture | None = None
    shown_at = time.monotonic()
    try:
        while not job.finished and not engine.test_break():
            if job.wait(WAIT_SECONDS):
                _update_progress(engine, job, view_name)
            picture = job.picture()
            if picture is not None and picture is not shown and time.monotonic() - shown_at > UPDATE_INTERVAL:
                _fill(passes, view_name, picture)
                engine.update_result(result)
                shown, shown_at = picture, time.monotonic()
        done = job.finished
        if done:
            _update_progress(engine, job, view_name)
        picture = job.picture()
        if picture is not None:
            _fill(passes, view_name, picture)
    finally:
        job.cancel()
        engine.end_result(result, cancel=bool(job.error) and job.picture() is None)
    if job.error:
        _report_error(engine, job.error)
    elif done and not engine.is_preview:
        for warning in (*job.warnings, *_noise(job)):
            engine.report({"WARNING"}, warning)
        render_statistics.store("render", job.statistics)
    return done and not job.error


def _noise(job: Job) -> Iterator[str]:
    """A sentence about a noisy picture that has all of its samples."""
    error = job.statistics.get("error", math.inf)
    if job.statistics.get("stopped_by") == "samples" and NOISY < error < math.inf:
        issue = f"The picture's error is still about {100.0 * error:.0f} % of its mean: more samples lower it"
        yield issue


def _fill(passes: bpy.types.RenderPasses, view_name: str, picture: Picture) -> None:
    for name, image in picture.passes.items():
        target = passes.find_by_name(name, view_name)
        if target is not None:
            # foreach_set copies in 3 ms; assigning to `rect` takes a second.
            target.rect.foreach_set(image.reshape(-1))


def _update_progress(engine: bpy.types.RenderEngine, job: Job, view_name: str) -> None:
    megabytes = job.statistics.get("bytes_uploaded", 0) / 2**20
    engine.update_progress(1.0 if job.finished else job.progress)
    engine.update_stats(view_name, job.status)
    engine.update_memory_stats(memory_used=megabytes, memory_peak=megabytes)


def _report_error(engine: bpy.types.RenderEngine, sentence: str) -> None:
    if not bpy.app.background:  # where it would be reported twice
        engine.error_set(sentence)
    engine.report({"ERROR"}, sentence)
