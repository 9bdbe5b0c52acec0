# SPDX-License-Identifier: GPL-3.0-or-later
"""The worker's promises: every job comes to an end, and one client never spoils another's picture."""

import threading
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.gl import context
from ism_addon.gpu.jobs.job import Job
from ism_addon.gpu.jobs.render_loop import draw_job as steps
from ism_addon.gpu.passes.upload.upload_lights import UploadLights
from ism_addon.gpu.passes.upload.upload_scene import UploadMaterials
from ism_addon.gpu.profile import COUNTS
from ism_addon.gpu.renderer import Renderer
from ism_addon.render_passes import RENDER_PASSES
from ism_addon.scene import Scene
from tests.scenes.small import pillar_field
from tests.support.jobs import LONG, request, wait_for_end, wait_for_picture
from tests.support.small_scenes import SMALL_SETTINGS, draw, with_quality


def test_a_job_gives_a_picture(worker, device):
    asked = request(with_quality(SMALL_SETTINGS, samples=3))
    job = worker.start(asked, "client")
    assert wait_for_end(job)
    picture = job.picture()
    assert job.error == ""
    assert (job.samples, job.samples_done, picture.samples) == (3, 3, 3)
    assert picture.color.shape == (16, 24, 4)
    assert {name: image.shape for name, image in picture.passes.items()} == {
        each.name: (16, 24, len(each.channels)) for each in RENDER_PASSES
    }
    assert all(image.dtype == np.float32 and image.flags.c_contiguous for image in picture.passes.values())
    assert np.array_equal(picture.color, draw(device, asked.scene, asked.view, asked.settings).color)


def test_triangles_are_drawn_once_unless_somebody_waits_for_the_first_picture(worker):
    asked = request(with_quality(SMALL_SETTINGS, samples=4))
    asked = replace(asked, view=replace(asked.view, filter_width=1.5))
    patient, waiting = (worker.start(replace(asked, preview_pixel_size=coarse), str(coarse)) for coarse in (0, 1))
    assert wait_for_end(patient)
    assert wait_for_end(waiting)
    assert waiting.statistics["triangles_drawn"] == 2 * patient.statistics["triangles_drawn"] > 0


def test_a_coarse_picture_comes_first_and_leaves_no_trace(device):
    asked = replace(request(with_quality(SMALL_SETTINGS, samples=3)), preview_pixel_size=4)
    job, renderers = Job(asked, threading.Condition()), (Renderer(device), Renderer(device))
    pictures = [job.picture() for _ in steps(*renderers, job) if job.picture()]
    assert pictures[0].color.shape == (4, 6, 4)
    assert pictures[0].color.any()
    assert pictures[0].samples == 0
    assert job.first_seconds > 0.0
    assert pictures[-1].samples == 3
    assert np.array_equal(pictures[-1].color, draw(device, asked.scene, asked.view, asked.settings).color)
    for renderer in renderers:
        renderer.release()


def test_depth_and_normals_are_metres_and_unit_vectors(worker):
    asked = request(size=(48, 32))
    job = worker.start(asked, "client")
    assert wait_for_end(job)
    depth, normal = job.picture().passes["Depth"][..., 0], job.picture().passes["Normal"]
    seen = depth < 1e9
    assert 0 < seen.sum() < seen.size
    assert (depth[~seen] == np.float32(1e10)).all()
    assert not normal[~seen].any()
    assert np.linalg.norm(normal[seen], axis=1) == pytest.approx(1.0, abs=1e-4)
    assert normal[seen][:, 2].max() == pytest.approx(1.0, abs=1e-3)


def test_statistics_are_plain_numbers(worker):
    job = worker.start(request(), "client")
    assert wait_for_end(job)
    told = job.statistics
    assert set(told) == {
        "passes",
        *COUNTS,
        "triangles",
        "samples",
        "seconds",
        "error",
        "stopped_by",
    }
    assert 0 < told["triangles_drawn"] <= told["triangles"] == 12 * 8**2 + 12 * 3**2
    assert told["virtual_lights"] == 0 < told["triangles_drawn"]  # by rays
    assert told["samples"] == 1
    assert told["bytes_uploaded"] > 0
    assert all(set(row) == {"drawn", "reused", "skipped", "ms"} for row in told["passes"].values())


def test_cancel_ends_a_job(worker):
    job = worker.start(request(LONG), "client")
    assert wait_for_picture(job)
    job.cancel()
    assert wait_for_end(job)
    assert job.error == ""
    assert 0 < job.samples_done < job.samples


def test_a_job_may_be_cancelled_at_once(worker):
    job = worker.start(request(LONG), "client")
    job.cancel()
    assert wait_for_end(job)
    assert job.error == ""


def test_a_newer_job_replaces_the_older_one(worker):
    older = worker.start(request(LONG), "client")
    assert wait_for_picture(older)
    newer = worker.start(request(), "client")
    assert wait_for_end(older)
    assert wait_for_end(newer)
    assert older.samples_done < older.samples
    assert newer.picture().samples == 1


def test_many_jobs_in_a_row_all_come_to_an_end(worker):
    """As while a slider is dragged: most are replaced before the worker has looked at them."""
    jobs = [worker.start(request(LONG), "client") for _ in range(40)]
    last = worker.start(request(), "client")
    assert wait_for_end(last)
    assert last.error == ""
    assert all(wait_for_end(job, 5.0) for job in jobs)


def test_the_replacing_job_has_its_own_picture(worker, device):
    """What was drawn for the older job must not be taken for the newer one's."""
    settings = with_quality(SMALL_SETTINGS, samples=2)
    other = request(settings, pillar_field)
    expected = draw(device, other.scene, other.view, settings).color
    for _ in range(5):
        assert wait_for_picture(worker.start(request(LONG), "client"))
        job = worker.start(other, "client")
        assert wait_for_end(job)
        assert np.array_equal(job.picture().color, expected)


def test_two_clients_at_once(worker, device):
    settings = with_quality(SMALL_SETTINGS, samples=6)
    asked = [request(settings), request(settings, pillar_field)]
    jobs = [worker.start(each, client) for client, each in enumerate(asked)]
    for job, each in zip(jobs, asked, strict=True):
        assert wait_for_end(job)
        assert np.array_equal(job.picture().color, draw(device, each.scene, each.view, settings).color)


def test_a_long_job_does_not_keep_another_client_waiting(worker):
    long = worker.start(request(LONG), "final render")
    assert wait_for_picture(long)
    short = worker.start(request(), "viewport")
    assert wait_for_end(short)
    assert not long.finished


def test_the_picture_is_one_object_until_there_is_a_newer_one(worker):
    job = worker.start(request(), "client")
    assert wait_for_end(job)
    assert job.picture() is job.picture()


def test_forgetting_a_client_ends_its_job_and_another_can_follow(worker):
    job = worker.start(request(LONG), "client")
    worker.forget("client")
    assert wait_for_end(job)
    worker.forget("client")
    worker.forget("never seen")
    assert wait_for_end(worker.start(request(), "client"))


def test_stop_ends_all_jobs_and_a_later_start_starts_anew(worker):
    jobs = [worker.start(request(LONG), client) for client in "abc"]
    worker.stop()
    assert all(job.finished for job in jobs)
    worker.stop()
    job = worker.start(request(), "a")
    assert wait_for_end(job)
    assert job.picture() is not None


def test_a_start_while_another_thread_stops(worker):
    """Whoever comes second, nobody waits for ever."""
    for _ in range(10):
        worker.start(request(LONG), "client")
        stopping = threading.Thread(target=worker.stop, daemon=True)
        stopping.start()
        job = worker.start(request(), "other")
        stopping.join(20.0)
        assert not stopping.is_alive()
        assert wait_for_end(job)


def test_a_request_that_cannot_be_drawn_is_an_error_of_its_own(worker):
    broken = worker.start(request(replace(SMALL_SETTINGS, debug_view="nonsense")), "one")
    sound = worker.start(request(), "two")
    assert wait_for_end(broken)
    assert wait_for_end(sound)
    assert "nonsense" in broken.error
    assert broken.picture() is None
    assert sound.error == ""
    assert wait_for_end(worker.start(request(), "one"))


def with_lights(scene: Scene) -> Scene:
    return replace(scene, lights=replace(scene.lights, radiance=3.0 * scene.lights.radiance))


def with_materials(scene: Scene) -> Scene:
    return replace(scene, materials=replace(scene.materials, base_color=0.1 * scene.materials.base_color))


@pytest.mark.parametrize(
    ("kind", "change"),
    [(UploadLights, with_lights), (UploadMaterials, with_materials)],
    ids=["UploadLights", "UploadMaterials"],
)
def test_the_picture_after_a_failed_one_is_that_of_a_new_renderer(worker, device, monkeypatch, kind, change):
    """What was made before it failed is not taken for what had been there before, for the client's earlier picture."""
    asked = request(with_quality(SMALL_SETTINGS, samples=2), size=(48, 32))
    other = replace(asked, scene=change(asked.scene))
    assert wait_for_end(worker.start(asked, "client"))
    draws = kind.execute

    def broken(step, frame):
        draws(step, frame)
        raise RuntimeError("broken")

    with monkeypatch.context() as breaks:
        breaks.setattr(kind, "execute", broken)
        failed = worker.start(other, "client")
        assert wait_for_end(failed)
    assert failed.error == "The picture could not be drawn: broken"
    again = worker.start(asked, "client")
    assert wait_for_end(again)
    assert np.array_equal(again.picture().color, draw(device, asked.scene, asked.view, asked.settings).color)


def test_waiting_is_told_of_news_and_otherwise_comes_back(worker):
    job = worker.start(request(), "client")
    assert wait_for_end(job)
    job.wait(0.0)
    assert job.wait(0.0)  # finished: never waits again
    idle = Job(request(), threading.Condition())
    assert not idle.wait(0.01)


def test_opengl_is_opened_before_anything_is_asked_for(worker, monkeypatch):
    """Once: whoever asks then finds it open."""
    opened = threading.Semaphore(0)
    open_device = context.open_device

    def open_and_tell() -> context.Device:
        device = open_device()
        opened.release()
        return device

    monkeypatch.setattr(context, "open_device", open_and_tell)
    worker.expect()
    assert opened.acquire(timeout=30.0)
    worker.expect()
    assert wait_for_end(worker.start(request(), "client"))
    assert not opened.acquire(blocking=False)
