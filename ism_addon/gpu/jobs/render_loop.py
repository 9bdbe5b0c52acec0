# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the worker's thread draws: renderers, kept for each client, and jobs, a pass at each step."""

import logging
import time
from collections.abc import Generator, Hashable
from itertools import chain

import numpy as np

from ...render_passes import COMBINED
from ...settings import Quality
from ..convergence import Convergence
from ..gl.context import Device
from ..gl.errors import Cancelled, ContextLost, GraphicsError
from ..profile import Profile
from ..renderer import Renderer
from .job import Job, Picture

log = logging.getLogger(__name__)

#: The part of the time that pictures may take which are only shown until there is a better one.
DISPLAY_TIME_FRACTION = 0.1


class RenderLoop:
    """A renderer a client, and how far their jobs are."""

    def __init__(self, device: Device, shader_version: int):
        self.device = device
        self.shader_version = shader_version
        #: Of each client: one for its pictures, and one for the coarse first ones. They share what they can.
        self.renderers: dict[Hashable, tuple[Renderer, Renderer]] = {}
        self.running: dict[Job, Generator[None, None, None]] = {}

    def tidy(self, jobs: dict[Hashable, Job], forgotten: set[Hashable]) -> None:
        """Drop jobs that were replaced, and the renderers of clients that are gone."""
        for job in self.running.keys() - set(jobs.values()):
            self.end(job)
        for client in forgotten:
            self.forget(client)

    def forget(self, client: Hashable) -> None:
        """Free what is kept for a client."""
        for renderer in self.renderers.pop(client, ()):
            renderer.release()

    def reload(self, shader_version: int) -> None:
        """Forget programs of earlier shaders, and renderers; a job that is running keeps its own to its end."""
        if shader_version != self.shader_version:
            self.shader_version = shader_version
            self.device.forget_programs()
            self.renderers.clear()
            self.device.free_released()

    def step(self, client: Hashable, job: Job) -> None:
        """Draw one pass of a job. Whatever goes wrong is its own error, but for ContextLost, which is raised."""
        self.device.on_compile[:] = [job.begin_program]
        try:
            if job not in self.running:
                self.running[job] = draw_job(*self.of(client), job)
            goes_on = not job.cancelled and next(self.running[job], job) is not job
            job.compiles = False
        except Cancelled:
            goes_on = False
        except ContextLost:
            raise
        except Exception as reason:  # anything of OpenGL's or the driver's: the thread must live on for the others
            log.debug("drawing failed", exc_info=True)
            self.end(job, f"The picture could not be drawn: {self.cause(reason)}")
            self.forget(client)
            return
        if not goes_on:
            self.end(job)

    def cause(self, reason: Exception) -> Exception:
        """Why drawing has failed: if OpenGL could not do what it was asked, our own failure only followed from that."""
        try:
            self.device.check()
        except GraphicsError as error:
            return error
        return reason

    def of(self, client: Hashable) -> tuple[Renderer, Renderer]:
        """The renderers that are kept for the client."""
        if client not in self.renderers:
            self.renderers[client] = Renderer(self.device), Renderer(self.device)
        return self.renderers[client]

    def end(self, job: Job, error: str = "") -> None:
        """Nothing more comes of this job."""
        if job in self.running:
            self.running.pop(job).close()
        job.tell(finished=True, error=error, compiles=False)

    def close(self) -> None:
        """Free all that the GPU holds for us. What becomes of jobs is the worker's to say."""
        for steps in self.running.values():
            steps.close()
        for renderer in chain(*self.renderers.values()):
            renderer.release()
        self.device.close()


def draw_job(renderer: Renderer, coarse_renderer: Renderer, job: Job) -> Generator[None, None, None]:
    """Draw all samples of a job, a pass at each step, and hand over pictures on the way."""
    request, profile, start = job.request, Profile(), time.perf_counter()

    def cancelled() -> bool:
        return job.cancelled

    if request.coarse > 1:
        sample = request.scene, request.view.coarse(request.coarse), request.settings, 0, profile
        for _ in coarse_renderer.sample(*sample, low_latency=True, cancelled=cancelled):
            coarse_renderer.device.check()
            yield
        job._picture = Picture(coarse_renderer.images([COMBINED]), 0)
        job.tell(first_seconds=coarse_renderer.pixel_pass_seconds(profile))
        yield
    next_picture, stopped_by = start, ""
    filtered = [each for each in request.passes if each.filtered]
    of_first_sample: dict[str, np.ndarray] = {}
    while not stopped_by:
        sample = request.scene, request.view, request.settings, job.samples_done, profile
        for _ in renderer.sample(*sample, low_latency=request.coarse > 0, cancelled=cancelled):
            if job.samples_done == 0:  # later ones do nothing new
                renderer.device.check()
            yield
        renderer.device.check()
        now = time.perf_counter()
        if job.samples_done == 0:
            of_first_sample = renderer.images([each for each in request.passes if not each.filtered])
        job.samples_done += 1
        stopped_by = stop_reason(request.settings.quality, job.samples_done, now - start, renderer.error)
        if stopped_by:
            renderer.submission.finish()
        job.first_seconds = job.first_seconds or renderer.pixel_pass_seconds(profile)
        job.statistics = profile.statistics(
            request.scene, job.samples_done, now - start, renderer.error.image_error, stopped_by
        )
        if stopped_by or now >= next_picture:
            job._picture = Picture(renderer.images(filtered) | of_first_sample, job.samples_done)
            shown = time.perf_counter()
            next_picture = shown + (shown - now) * (1.0 - DISPLAY_TIME_FRACTION) / DISPLAY_TIME_FRACTION
        job.tell()
        yield


def stop_reason(quality: Quality, samples: int, seconds: float, error: Convergence) -> str:
    """Why a picture that has so many samples after so many seconds has no more; "" if it has."""
    if samples >= quality.samples:
        return "samples"
    if error.converged.all():
        return "error"
    return "time" if 0.0 < quality.time_limit <= seconds else ""
