# SPDX-License-Identifier: GPL-3.0-or-later
"""The thread that owns the OpenGL context: requests in, pictures out.

A context opened in Blender's main thread is silently wrong, and waiting for the GPU there would freeze the window;
so one thread does all OpenGL, a pass at a time, and takes turns between its clients (viewports, final renders).
Nobody waits for it unless they ask to.
"""

import logging
import threading
import time
from collections.abc import Hashable, Iterator
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from ..scene import Scene, View
from ..settings import Settings
from .profile import Profile

if TYPE_CHECKING:
    from .context import Device
    from .renderer import Renderer

log = logging.getLogger(__name__)

#: The part of the time that pictures may take which are only shown until there is a better one.
SHOWING = 0.1


@dataclass(frozen=True, eq=False)
class Request:
    """What is to be drawn."""

    scene: Scene
    view: View
    settings: Settings
    surfaces: bool = True  # whether depth and normals are wanted too
    coarse: int = 1  # px of the view along either side of one in the first picture, which comes the sooner


@dataclass(frozen=True, eq=False)
class Picture:
    """The average of `samples` samples, or of none the coarse first picture. Bottom row first."""

    color: np.ndarray  # (H,W,4) float32 linear, alpha premultiplied
    depth: np.ndarray | None  # (H,W) float32 m along the view's axis, 1e10 where nothing is
    normal: np.ndarray | None  # (H,W,3) float32 world space
    samples: int


class Job:
    """One request on its way. All of it may be asked from any thread."""

    def __init__(self, request: Request, news: threading.Condition):
        self.request = request
        self.samples = request.settings.quality.samples
        self.samples_done = 0
        self.first_seconds = 0.0  # that the pixels of the first picture took, as soon as there is one
        self.finished = False
        self.cancelled = False
        self.error = ""
        self.statistics: dict = {}
        self._news = news
        self._seen = 0
        self._happened = 0
        self._picture: Picture | None = None

    def picture(self) -> Picture | None:
        """The newest picture, the same object until there is a newer one."""
        return self._picture

    def wait(self, timeout: float) -> bool:
        """Until there is news since the last call, or `timeout` seconds: whether there was any."""
        with self._news:
            told = self._news.wait_for(lambda: self._happened != self._seen or self.finished, timeout)
            self._seen = self._happened
            return told

    def cancel(self) -> None:
        """Stop after the pass that is being drawn."""
        self.cancelled = True

    def tell(self, **changes: object) -> None:
        """Set attributes and wake whoever waits. The worker's side."""
        with self._news:
            for name, value in changes.items():
                setattr(self, name, value)
            self._happened += 1
            self._news.notify_all()


class Worker:
    """Draws the newest job of each client, in turns."""

    def __init__(self) -> None:
        self._news = threading.Condition()
        self._jobs: dict[Hashable, Job] = {}
        self._forgotten: set[Hashable] = set()
        self._thread: threading.Thread | None = None
        #: Of the shaders: pictures of another edition may differ.
        self.edition = 0

    def start(self, request: Request, client: Hashable) -> Job:
        """Draw this instead of what the client asked for before."""
        job = Job(request, self._news)
        with self._news:
            self._drop(client)
            self._jobs[client] = job
            self._forgotten.discard(client)
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="ISM renderer", daemon=True)
                self._thread.start()
            self._news.notify_all()
        return job

    def reload(self) -> None:
        """Read the shaders' files again for all jobs that are started from now on."""
        with self._news:
            self.edition += 1

    def forget(self, client: Hashable) -> None:
        """Cancel the client's job and free what is kept for it."""
        with self._news:
            self._drop(client)
            self._forgotten.add(client)
            self._news.notify_all()

    def stop(self) -> None:
        """End all jobs and the thread, and wait for it."""
        with self._news:
            thread, self._thread = self._thread, None
            for client in list(self._jobs):
                self._drop(client)
            self._news.notify_all()
        if thread is not None:
            thread.join()

    def _drop(self, client: Hashable) -> None:
        """End the client's job, even if the thread has not seen it yet. With the lock held."""
        job = self._jobs.pop(client, None)
        if job is not None:
            job.cancel()
            job.tell(finished=True)

    def _run(self) -> None:
        try:
            from .context import NoOpenGL, open_device
        except ImportError as reason:
            self._refuse(f"moderngl, which comes with the extension, could not be loaded ({reason})")
            return
        try:
            device = open_device()
        except NoOpenGL as reason:
            self._refuse(str(reason))
            return
        studio = Studio(device, self.edition)
        while True:
            with self._news:
                self._news.wait_for(self._has_work)
                if self._stopped():
                    break
                jobs = {client: job for client, job in self._jobs.items() if not job.finished}
                forgotten, self._forgotten = self._forgotten, set()
                edition = self.edition
            studio.tidy(jobs, forgotten)
            studio.reload(edition)
            for client, job in jobs.items():
                studio.step(client, job)
        studio.close()

    def _has_work(self) -> bool:
        return self._stopped() or bool(self._forgotten) or any(not job.finished for job in self._jobs.values())

    def _stopped(self) -> bool:
        """Whether the calling thread is no longer the worker's own: stop() may be followed by another one at once."""
        return self._thread is not threading.current_thread()

    def _refuse(self, reason: str) -> None:
        """Answer everyone who asked with `reason`; the next request tries again."""
        with self._news:
            if self._stopped():
                return
            self._thread = None
            jobs = list(self._jobs.values())
            self._jobs.clear()
        for job in jobs:
            job.tell(error=reason, finished=True)


class Studio:
    """The worker's side: a renderer a client, and how far their jobs are. Lives in the worker's thread."""

    def __init__(self, device: "Device", edition: int):
        self.device = device
        self.edition = edition
        #: Of each client: one for its pictures, and one for the coarse first ones. They share what they can.
        self.renderers: dict[Hashable, tuple[Renderer, Renderer]] = {}
        self.running: dict[Job, Iterator[None]] = {}

    def tidy(self, jobs: dict[Hashable, Job], forgotten: set[Hashable]) -> None:
        """Drop jobs that were replaced, and the renderers of clients that are gone."""
        for job in self.running.keys() - set(jobs.values()):
            self.end(job)
        for client in forgotten & self.renderers.keys():
            for renderer in self.renderers.pop(client):
                renderer.release()

    def reload(self, edition: int) -> None:
        """Forget programs of an earlier edition, and renderers; a job that is running keeps its own to its end."""
        if edition != self.edition:
            self.edition = edition
            self.device.programs.clear()
            self.renderers.clear()
            self.device.gl.gc()

    def step(self, client: Hashable, job: Job) -> None:
        """Draw one pass of a job; whatever goes wrong is the job's own error."""
        error = ""
        try:
            if job not in self.running:
                self.running[job] = draw(*self.of(client), job)
            if not job.cancelled and next(self.running[job], job) is not job:
                return
        except Exception as reason:  # anything of OpenGL's or the driver's: the thread must live on for the others
            log.debug("drawing failed", exc_info=True)
            error = f"The picture could not be drawn: {reason}"
        self.end(job, error)

    def of(self, client: Hashable) -> "tuple[Renderer, Renderer]":
        """The renderers that are kept for the client."""
        from .renderer import Renderer

        if client not in self.renderers:
            self.renderers[client] = Renderer(self.device), Renderer(self.device)
        return self.renderers[client]

    def end(self, job: Job, error: str = "") -> None:
        """Nothing more comes of this job."""
        if job in self.running:
            self.running.pop(job).close()
        job.tell(finished=True, error=error)

    def close(self) -> None:
        """Free all that the GPU holds for us."""
        for job in list(self.running):
            self.end(job)
        for renderer in chain(*self.renderers.values()):
            renderer.release()
        self.device.close()


def draw(renderer: "Renderer", coarse_renderer: "Renderer", job: Job) -> Iterator[None]:
    """Draw all samples of a job, a pass at each step, and hand over pictures on the way."""
    request, profile = job.request, Profile()
    if request.coarse > 1:
        view = request.view.coarse(request.coarse)
        for _ in coarse_renderer.sample(request.scene, view, request.settings, 0, profile):
            yield
        job._picture = Picture(coarse_renderer.picture(), None, None, 0)
        job.tell(first_seconds=coarse_renderer.seconds_of_pixels(profile))
        yield
    start = time.perf_counter()
    next_picture = start
    surfaces: tuple[np.ndarray | None, np.ndarray | None] = None, None
    for sample in range(job.samples):
        for _ in renderer.sample(request.scene, request.view, request.settings, sample, profile):
            yield
        now = time.perf_counter()
        if sample == 0 and request.surfaces:
            surfaces = renderer.depth_and_normal()
        job.samples_done = sample + 1
        job.first_seconds = job.first_seconds or renderer.seconds_of_pixels(profile)
        job.statistics = profile.statistics(request.scene, sample + 1, now - start)
        if sample + 1 == job.samples or now >= next_picture:
            job._picture = Picture(renderer.picture(), *surfaces, sample + 1)
            shown = time.perf_counter()
            next_picture = shown + (shown - now) * (1.0 - SHOWING) / SHOWING
        job.tell()
        yield


#: The worker that Blender's engine uses.
shared = Worker()
