# SPDX-License-Identifier: GPL-3.0-or-later
"""The thread that owns the OpenGL context: requests in, pictures out.

Blender's main thread has its own current context, and waiting for the GPU there would freeze the window. So one thread
makes all OpenGL calls, one pass at a time, alternating between its clients (viewports, final renders).
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

#: Seconds that stop() waits for the current pass. Some passes take longer, and a driver may hang.
JOIN_TIMEOUT = 2.0


class RenderThread:
    """Draws the latest job of each client, alternating between clients."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._jobs: dict[Hashable, Job] = {}
        self._forgotten: set[Hashable] = set()
        self._thread: threading.Thread | None = None
        self._pause_ends = 0.0  # monotonic s
        self._is_paused = False
        #: Number of reloads of the shaders. Pictures of different versions may differ.
        self.shader_version = 0
        _instances.add(self)

    def start(self, request: Request, client: Hashable) -> Job:
        """Start a job, which replaces the client's earlier one."""
        job = Job(request, self._changed)
        with self._changed:
            self._drop(client)
            self._jobs[client] = job
            self._forgotten.discard(client)
            self._ensure_thread()
            self._changed.notify_all()
        return job

    def expect(self) -> None:
        """Open OpenGL now, while the scene of a coming request is still being read."""
        with self._changed:
            self._ensure_thread()

    def _ensure_thread(self) -> None:
        """Start the thread if there is none. With the lock held."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._run, name="ISM renderer", daemon=True)
            self._thread.start()

    def reload(self) -> None:
        """Compile the shaders again for all jobs that start from now on."""
        with self._changed:
            self.shader_version += 1

    def forget(self, client: Hashable) -> None:
        """Cancel the client's job and free its renderers."""
        with self._changed:
            self._drop(client)
            self._forgotten.add(client)
            self._changed.notify_all()

    def pause(self, seconds: float) -> None:
        """Begin no pass until resume(), or for `seconds`."""
        with self._changed:
            self._pause_ends = time.monotonic() + seconds

    def resume(self) -> None:
        """End a pause."""
        with self._changed:
            self._pause_ends = 0.0
            self._changed.notify_all()

    @property
    def is_idle(self) -> bool:
        """Whether no pass is being executed."""
        with self._changed:
            return self._is_paused or self._thread is None or not self._has_jobs()

    def stop(self) -> None:
        """End all jobs and the thread. If the current pass takes longer than JOIN_TIMEOUT, the thread ends later."""
        with self._changed:
            thread, self._thread = self._thread, None
            for client in list(self._jobs):
                self._drop(client)
            self._changed.notify_all()
        if thread is not None:
            thread.join(JOIN_TIMEOUT)

    def _after_fork(self) -> None:
        """Reset in the child process: the thread does not exist there, and may have held the lock."""
        self._changed, jobs, self._jobs = threading.Condition(), self._jobs, {}
        self._thread, self._is_paused = None, False
        self._forgotten.clear()
        for job in jobs.values():
            job._changed = self._changed
            job.notify(error="The picture is drawn by the process that this one was forked from", finished=True)

    def _drop(self, client: Hashable) -> None:
        """End the client's job, even if the thread has not started it. With the lock held."""
        job = self._jobs.pop(client, None)
        if job is not None:
            job.cancel()
            job.notify(finished=True)

    def _run(self) -> None:
        """Draw until stop(). If the thread ends earlier, all jobs fail; the next request starts a new thread."""
        sentence = "The thread that draws has ended unexpectedly: render again"
        try:
            try:
                moderngl_version.check()
                from ..gl.context import open_device
                from .render_loop import RenderLoop
            except (ImportError, OSError) as reason:
                sentence = (
                    f"moderngl, which comes with the extension, could not be loaded ({reason}): "
                    "install the extension again"
                )
                return
            with closing(RenderLoop(open_device(), self.shader_version)) as loop:
                self._draw(loop)
        except (NoOpenGL, ContextLost) as reason:
            sentence = str(reason)
        finally:
            self._fail_jobs(sentence)

    def _draw(self, loop: "RenderLoop") -> None:
        """Draw all jobs, until stop()."""
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._stopped() or self._has_jobs())
                if self._stopped():
                    return
                jobs = {client: job for client, job in self._jobs.items() if not job.finished}
                forgotten, self._forgotten = self._forgotten, set()
                shader_version = self.shader_version
            loop.tidy(jobs, forgotten)
            loop.reload(shader_version)
            for client, job in jobs.items():
                self._wait_while_paused()
                loop.step(client, job)

    def _wait_while_paused(self) -> None:
        """Wait until a pause ends."""
        with self._changed:
            self._is_paused = True
            while (remaining := self._pause_ends - time.monotonic()) > 0.0 and not self._stopped():
                self._changed.wait(remaining)
            self._is_paused = False

    def _has_jobs(self) -> bool:
        """Whether there is something to draw or to free. With the lock held."""
        return bool(self._forgotten) or any(not job.finished for job in self._jobs.values())

    def _stopped(self) -> bool:
        """Whether the calling thread was stopped; a new thread may already be running."""
        return self._thread is not threading.current_thread()

    def _fail_jobs(self, reason: str) -> None:
        """End all jobs with the error `reason`; the next request starts a new thread."""
        with self._changed:
            if self._stopped():
                return
            self._thread = None
            jobs = [job for job in self._jobs.values() if not job.finished]
            self._jobs.clear()
        for job in jobs:
            job.notify(error=reason, finished=True)


def _after_fork() -> None:
    for instance in _instances:
        instance._after_fork()


#: All render threads of this process.
_instances: weakref.WeakSet[RenderThread] = weakref.WeakSet()
if hasattr(os, "register_at_fork"):  # not in Windows
    os.register_at_fork(after_in_child=_after_fork)

#: The render thread of Blender's engine.
shared = RenderThread()
