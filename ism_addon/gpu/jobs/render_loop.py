# SPDX-License-Identifier: GPL-3.0-or-later
"""The work of the render thread: renderers for each client, and jobs, one pass per step."""

import logging
import time
from collections.abc import Generator, Hashable, Iterator
from itertools import chain

import numpy as np

from ...render_passes import COMBINED
from ...scene import Scene
from ..convergence import Convergence
from ..gl.context import Device
from ..gl.errors import Cancelled, ContextLost, GraphicsError
from ..profile import Profile
from ..renderer import Renderer
from .compile_graphs import compile_graphs
from .job import Job, Picture
from .refinement import sample_limit, sufficient_errors

log = logging.getLogger(__name__)

#: Maximum fraction of the render's time for reading back intermediate pictures. With less time, there are fewer.
DISPLAY_TIME_FRACTION = 0.1


class RenderLoop:
    """The renderers of all clients, and their running jobs."""

    def __init__(self, device: Device, shader_version: int):
        self.device = device
        self.shader_version = shader_version
        #: For each client, one for pictures and one for previews. They share resources.
        self.renderers: dict[Hashable, tuple[Renderer, Renderer]] = {}
        self.running: dict[Job, Generator[None, None, None]] = {}

    def tidy(self, jobs: dict[Hashable, Job], forgotten: set[Hashable]) -> None:
        """End jobs that were replaced, and free the renderers of forgotten clients."""
        for job in self.running.keys() - set(jobs.values()):
            self.end(job)
        for client in forgotten:
            self.forget(client)

    def forget(self, client: Hashable) -> None:
        """Free a client's renderers."""
        for renderer in self.renderers.pop(client, ()):
            renderer.release()

    def reload(self, shader_version: int) -> None:
        """On a new shader version, drop programs and renderers. A running job keeps its renderer."""
        if shader_version != self.shader_version:
            self.shader_version = shader_version
            self.device.forget_programs()
            self.renderers.clear()
            self.device.free_released()

    def step(self, client: Hashable, job: Job) -> None:
        """Execute one pass of a job. Errors become the job's error, except ContextLost, which is raised."""
        self.device.on_compile[:] = [job.begin_program]
        try:
            if job not in self.running:
                self.running[job] = draw_job(*self.renderers_of(client), job)
            continues = not job.cancelled and next(self.running[job], job) is not job
            job.compiles = False
        except Cancelled:
            continues = False
        except ContextLost:
            raise
        except Exception as reason:  # of OpenGL or the driver: the thread must go on for other jobs
            log.debug("drawing failed", exc_info=True)
            self.end(job, f"The picture could not be drawn: {self.cause(reason)}")
            self.forget(client)
            return
        if not continues:
            self.end(job)

    def cause(self, reason: Exception) -> Exception:
        """The cause of a failure: an OpenGL error, if there is one, else `reason`."""
        try:
            self.device.check()
        except GraphicsError as error:
            return error
        return reason

    def renderers_of(self, client: Hashable) -> tuple[Renderer, Renderer]:
        """The renderers of a client."""
        if client not in self.renderers:
            self.renderers[client] = Renderer(self.device), Renderer(self.device)
        return self.renderers[client]

    def end(self, job: Job, error: str = "") -> None:
        """End a job."""
        if job in self.running:
            self.running.pop(job).close()
        job.notify(finished=True, error=error, compiles=False, graph=0, graphs=0)

    def close(self) -> None:
        """Free all renderers and the context."""
        for steps in self.running.values():
            steps.close()
        for renderer in chain(*self.renderers.values()):
            renderer.release()
        self.device.close()


def draw_job(renderer: Renderer, preview_renderer: Renderer, job: Job) -> Generator[None, None, None]:
    """Draw all samples of a job, one pass per step, and store intermediate pictures."""
    request, profile, start = job.request, Profile(), time.perf_counter()
    quality = request.settings.quality

    def cancelled() -> bool:
        return job.cancelled

    def preview(scene: Scene, profile: Profile) -> Iterator[None]:
        view = request.view.with_larger_pixels(request.preview_pixel_size)
        sample = scene, view, request.settings, 0, profile
        for _ in preview_renderer.sample(*sample, low_latency=True, cancelled=cancelled):
            preview_renderer.device.check()
            yield
        job._picture = Picture(preview_renderer.images([COMBINED]), 0)
        job.notify()

    yield from compile_graphs(preview_renderer, job, cancelled, preview)
    if request.preview_pixel_size > 1:
        yield from preview(request.scene, profile)
        job.notify(first_seconds=preview_renderer.pixel_pass_seconds(profile))
        yield
    next_image_time, stopped_by = start, ""
    filtered = [each for each in request.passes if each.filtered]
    first_sample_images: dict[str, np.ndarray] = {}
    while not stopped_by:
        sample = request.scene, request.view, request.settings, job.samples_done, profile
        for _ in renderer.sample(*sample, low_latency=request.preview_pixel_size > 0, cancelled=cancelled):
            if job.samples_done == 0:  # later samples allocate nothing
                renderer.device.check()
            yield
        renderer.device.check()
        now = time.perf_counter()
        if job.samples_done == 0:
            first_sample_images = renderer.images([each for each in request.passes if not each.filtered])
        job.samples_done += 1
        if renderer.is_adaptive:
            job.samples = sample_limit(quality, job.samples_done, renderer.error, renderer.excess_lights)
            if quality.samples <= job.samples_done < job.samples:
                renderer.error.stop_below(sufficient_errors(quality, renderer.error, renderer.excess_lights))
        job.progress = max(job.progress, job.samples_done / job.samples)
        stopped_by = stop_reason(job, now - start, renderer.error)
        if stopped_by:
            renderer.submission.finish()
        job.first_seconds = job.first_seconds or renderer.pixel_pass_seconds(profile)
        job.warnings = tuple(sorted(profile.warnings))
        job.statistics = profile.statistics(
            request.scene, job.samples_done, now - start, renderer.error.image_error, stopped_by
        )
        if stopped_by or now >= next_image_time:
            job._picture = Picture(renderer.images(filtered) | first_sample_images, job.samples_done)
            read_back_end = time.perf_counter()
            next_image_time = (
                read_back_end + (read_back_end - now) * (1.0 - DISPLAY_TIME_FRACTION) / DISPLAY_TIME_FRACTION
            )
        job.notify()
        yield


def stop_reason(job: Job, seconds: float, error: Convergence) -> str:
    """Why a job stops after `seconds` s: "samples", "error" or "time"; "" if it goes on."""
    if job.samples_done >= job.samples:
        return "samples"
    if error.converged.all():
        return "error"
    return "time" if 0.0 < job.request.settings.quality.time_limit <= seconds else ""
