# SPDX-License-Identifier: GPL-3.0-or-later
"""The final render of one view layer: every stereo view of it, sample by sample, into Blender's passes."""

import time
from collections.abc import Callable

import bpy

from ...gpu.jobs.job import Job, Picture, Request
from ...gpu.jobs.render_thread import shared
from ...render_passes import asked_for
from ...scene import View
from ...setting_limits import beyond_limits, images_beyond_limits, view_beyond_limits
from ..sync import camera
from . import persistent_data, read_settings, render_statistics

WAIT = 0.1  # s: how long a wish to cancel can go unnoticed
SHOW_EVERY = 1.0  # s: an intermediate picture costs a copy and a redraw


def render(engine: bpy.types.RenderEngine, depsgraph: bpy.types.Depsgraph) -> None:
    """Render the depsgraph's view layer. What cannot be drawn becomes one sentence in the engine's report."""
    layer = depsgraph.view_layer_eval
    shares = persistent_data.LayerCache() if engine.is_preview else persistent_data.layer_cache(depsgraph)
    view_names = _view_names(engine, layer.name)
    shared.expect()
    try:
        scene = shares.read(depsgraph, _all_until_cancelled(engine))
    except _Cancelled:
        shares.reader.invalidate()  # what has changed is not told again
        for view_name in view_names:  # black: Blender would crash as it saves none at all
            engine.end_result(engine.begin_result(0, 0, 1, 1, layer=layer.name, view=view_name))
        return
    chosen = read_settings.read(depsgraph.scene_eval, "viewport" if engine.is_preview else "render")
    if not engine.is_preview:
        for warning in (*scene.warnings, *images_beyond_limits(scene.images), *beyond_limits(chosen)):
            engine.report({"WARNING"}, warning)
    passes = asked_for(layer)
    try:
        for view_name in view_names:
            engine.active_view_set(view_name)
            view = camera.final_view(depsgraph, engine)
            if view_name == view_names[0] and not engine.is_preview:
                for warning in view_beyond_limits(view):
                    engine.report({"WARNING"}, warning)
            job = shared.start(Request(scene, view, chosen, passes), shares.client)
            if not _render_view(engine, job, view, layer.name, view_name):
                break
    except camera.CameraError as error:
        _refuse(engine, str(error))
    finally:
        if engine.is_preview:
            shared.forget(shares.client)


class _Cancelled(Exception):
    """The user has pressed Escape while the scene was read."""


def _all_until_cancelled(engine: bpy.types.RenderEngine) -> Callable[[bpy.types.Object], bool]:
    """What is shown, which is asked of every object before it is read: all of them. Raises _Cancelled."""

    def shown(_object: bpy.types.Object) -> bool:
        if engine.test_break():
            raise _Cancelled
        return True

    return shown


def _view_names(engine: bpy.types.RenderEngine, layer: str) -> list[str]:
    """The stereo views to render: only a result knows them. A plain render has one, without a name."""
    probe = engine.begin_result(0, 0, 1, 1, layer=layer)
    names = [view.name for view in probe.views]
    engine.end_result(probe, cancel=True)
    return names


def _render_view(engine: bpy.types.RenderEngine, job: Job, view: View, layer: str, view_name: str) -> bool:
    """Follow a job until it is done, cancelled or failed, and keep the best picture there is. True when done."""
    result = engine.begin_result(0, 0, view.width, view.height, layer=layer, view=view_name)
    passes = result.layers[0].passes
    shown: Picture | None = None
    shown_at = time.monotonic()
    try:
        while not job.finished and not engine.test_break():
            if job.wait(WAIT):
                _tell_progress(engine, job, view_name)
            picture = job.picture()
            if picture is not None and picture is not shown and time.monotonic() - shown_at > SHOW_EVERY:
                _fill(passes, view_name, picture)
                engine.update_result(result)
                shown, shown_at = picture, time.monotonic()
        done = job.finished
        if done:
            _tell_progress(engine, job, view_name)
        picture = job.picture()
        if picture is not None:
            _fill(passes, view_name, picture)
    finally:
        job.cancel()
        engine.end_result(result, cancel=bool(job.error) and job.picture() is None)
    if job.error:
        _refuse(engine, job.error)
    elif done and not engine.is_preview:
        render_statistics.store("render", job.statistics)
    return done and not job.error


def _fill(passes: bpy.types.RenderPasses, view_name: str, picture: Picture) -> None:
    for name, image in picture.passes.items():
        target = passes.find_by_name(name, view_name)
        if target is not None:
            # Blender takes nothing else here; it copies in 3 ms what `rect = array` takes a second for.
            target.rect.foreach_set(image.reshape(-1))


def _tell_progress(engine: bpy.types.RenderEngine, job: Job, view_name: str) -> None:
    megabytes = job.statistics.get("bytes_uploaded", 0) / 2**20
    engine.update_progress(1.0 if job.finished else job.samples_done / job.samples)
    engine.update_stats(view_name, job.status)
    engine.update_memory_stats(memory_used=megabytes, memory_peak=megabytes)


def _refuse(engine: bpy.types.RenderEngine, sentence: str) -> None:
    if not bpy.app.background:  # where it would be a second report
        engine.error_set(sentence)
    engine.report({"ERROR"}, sentence)
