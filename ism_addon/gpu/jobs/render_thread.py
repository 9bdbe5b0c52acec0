# SPDX-License-Identifier: GPL-3.0-or-later
"""The thread that owns the OpenGL context: requests in, pictures out.

A context opened in Blender's main thread is silently wrong, and waiting for the GPU there would freeze the window;
so one thread does all OpenGL, a pass at a time, and takes turns between its clients (viewports, final renders).
Nobody waits for it unless they ask to.
"""

import os
import threading
import time
import weakref
from collections.abc import Hashable
from contextlib import closing
from typing import TYPE_CHECKING

from ..gl import moderngl_version
from ..gl.errors import ContextLost, NoOpenGL
from .job import Job, Request

if TYPE_CHECKING:
    from .render_loop import RenderLoop

#: s that stop() waits for the pass under way. Some take longer, and where a driver hangs it has no end.
PATIENCE = 2.0


class RenderThread:
    """Draws the newest job of each client, in turns."""

    def __init__(self) -> None:
        self._news = threading.Condition()
        self._jobs: dict[Hashable, Job] = {}
        self._forgotten: set[Hashable] = set()
        self._thread: threading.Thread | None = None
        self._rest_ends = 0.0  # monotonic s
        self._rests = False
        #: Counts how often shaders were read anew: pictures of another version may differ.
        self.shader_version = 0
        _workers.add(self)

    def start(self, request: Request, client: Hashable) -> Job:
        """Draw this instead of what the client asked for before."""
        job = Job(request, self._news)
        with self._news:
            self._drop(client)
            self._jobs[client] = job
            self._forgotten.discard(client)
            self._begin()
            self._news.notify_all()
        return job

    def expect(self) -> None:
        """Open OpenGL now: a request is to come, as soon as its scene is read."""
        with self._news:
            self._begin()

    def _begin(self) -> None:
        """See that there is a thread. With the lock held."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._run, name="ISM renderer", daemon=True)
            self._thread.start()

    def reload(self) -> None:
        """Read the shaders' files again for all jobs that are started from now on."""
        with self._news:
            self.shader_version += 1

    def forget(self, client: Hashable) -> None:
        """Cancel the client's job and free what is kept for it."""
        with self._news:
            self._drop(client)
            self._forgotten.add(client)
            self._news.notify_all()

    def rest(self, seconds: float) -> None:
        """Begin no pass until go_on(), or for so long: for those who have something short to do undisturbed."""
        with self._news:
            self._rest_ends = time.monotonic() + seconds

    def go_on(self) -> None:
        """End a rest."""
        with self._news:
            self._rest_ends = 0.0
            self._news.notify_all()

    @property
    def is_still(self) -> bool:
        """Whether nothing is being drawn."""
        with self._news:
            return self._rests or self._thread is None or not self._has_work()

    def stop(self) -> None:
        """End all jobs and the thread. Where its pass is a long one, it frees what it has and ends later, by itself."""
        with self._news:
            thread, self._thread = self._thread, None
            for client in list(self._jobs):
                self._drop(client)
            self._news.notify_all()
        if thread is not None:
            thread.join(PATIENCE)

    def _after_fork(self) -> None:
        """In the child: its threads are not there, and whoever held the lock might never give it back."""
        self._news, jobs, self._jobs = threading.Condition(), self._jobs, {}
        self._thread, self._rests = None, False
        self._forgotten.clear()
        for job in jobs.values():
            job._news = self._news
            job.tell(error="The picture is drawn by the process that this one was forked from", finished=True)

    def _drop(self, client: Hashable) -> None:
        """End the client's job, even if the thread has not seen it yet. With the lock held."""
        job = self._jobs.pop(client, None)
        if job is not None:
            job.cancel()
            job.tell(finished=True)

    def _run(self) -> None:
        """Draw until stop(). Whatever ends it before is told to all who have asked; who asks next begins anew."""
        why = "The thread that draws has ended unexpectedly: render again"
        try:
            try:
                moderngl_version.check()
                from ..gl.context import open_device
                from .render_loop import RenderLoop
            except (ImportError, OSError) as reason:
                why = (
                    f"moderngl, which comes with the extension, could not be loaded ({reason}): "
                    "install the extension again"
                )
                return
            with closing(RenderLoop(open_device(), self.shader_version)) as studio:
                self._draw(studio)
        except (NoOpenGL, ContextLost) as reason:
            why = str(reason)
        finally:
            self._refuse(why)

    def _draw(self, studio: "RenderLoop") -> None:
        """All that is asked for, until stop()."""
        while True:
            with self._news:
                self._news.wait_for(self._has_work)
                if self._stopped():
                    return
                jobs = {client: job for client, job in self._jobs.items() if not job.finished}
                forgotten, self._forgotten = self._forgotten, set()
                shader_version = self.shader_version
            studio.tidy(jobs, forgotten)
            studio.reload(shader_version)
            for client, job in jobs.items():
                self._rest()
                studio.step(client, job)

    def _rest(self) -> None:
        """Wait as long as a rest lasts."""
        with self._news:
            self._rests = True
            while (left := self._rest_ends - time.monotonic()) > 0.0 and not self._stopped():
                self._news.wait(left)
            self._rests = False

    def _has_work(self) -> bool:
        return self._stopped() or bool(self._forgotten) or any(not job.finished for job in self._jobs.values())

    def _stopped(self) -> bool:
        """Whether the calling thread is no longer the worker's own: stop() may be followed by another one at once."""
        return self._thread is not threading.current_thread()

    def _refuse(self, reason: str) -> None:
        """Answer everyone who waits with `reason`; the next request tries again."""
        with self._news:
            if self._stopped():
                return
            self._thread = None
            jobs = [job for job in self._jobs.values() if not job.finished]
            self._jobs.clear()
        for job in jobs:
            job.tell(error=reason, finished=True)


def _after_fork() -> None:
    for worker in _workers:
        worker._after_fork()


#: All there are.
_workers: weakref.WeakSet[RenderThread] = weakref.WeakSet()
if hasattr(os, "register_at_fork"):  # not in Windows
    os.register_at_fork(after_in_child=_after_fork)

#: The worker that Blender's engine uses.
shared = RenderThread()
