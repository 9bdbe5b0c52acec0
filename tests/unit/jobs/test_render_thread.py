# SPDX-License-Identifier: GPL-3.0-or-later
"""The render thread: every job ends, and no client affects another client's picture."""

import threading
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.gl import context
from ism_addon.gpu.jobs.job import Job
from ism_addon.gpu.jobs.render_loop import draw_job
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
    requested = request(with_quality(SMALL_SETTINGS, samples=3))
    job = worker.start(requested, "client")
    assert wait_for_end(job)
    picture = job.picture()
    assert job.error == ""
    assert (job.samples, job.samples_done, picture.samples) == (3, 3, 3)
    assert picture.color.shape == (16, 24, 4)
    assert {name: image.shape for name, image in picture.passes.items()} == {
        each.name: (16, 24, len(each.channels)) for each in RENDER_PASSES
    }
    assert all(image.dtype == np.float32 and image.flags.c_contiguous for image in picture.passes.values())
    assert np.array_equal(picture.color, draw(device, requested.scene, requested.view, requested.settings).color)


def test_triangles_are_drawn_once_unless_the_first_picture_is_urgent(worker):
    requested = request(with_quality(SMALL_SETTINGS, samples=4))
    requested = replace(requested, view=replace(requested.view, filter_width=1.5))
    final, viewport = (worker.start(replace(requested, preview_pixel_size=size), str(size)) for size in (0, 1))
    assert wait_for_end(final)
    assert wait_for_end(viewport)
    assert viewport.statistics["triangles_drawn"] == 2 * final.statistics["triangles_drawn"] > 0


def test_a_coarse_picture_comes_first_and_does_not_change_the_final_one(device):
    requested = replace(request(with_quality(SMALL_SETTINGS, samples=3)), preview_pixel_size=4)
    job, renderers = Job(requested, threading.Condition()), (Renderer(device), Renderer(device))
    pictures = [job.picture() for _ in draw_job(*renderers, job) if job.picture()]
    assert pictures[0].color.shape == (4, 6, 4)
    assert pictures[0].color.any()
    assert pictures[0].samples == 0
    assert job.first_seconds > 0.0
    assert pictures[-1].samples == 3
    assert np.array_equal(pictures[-1].color, draw(device, requested.scene, requested.view, requested.settings).color)
    for renderer in renderers:
        renderer.release()


def test_depth_and_normals_are_metres_and_unit_vectors(worker):
    job = worker.start(request(size=(48, 32)), "client")
    assert wait_for_end(job)
    depth, normal = job.picture().passes["Depth"][..., 0], job.picture().passes["Normal"]
    exists = depth < 1e9
    assert 0 < exists.sum() < exists.size
    assert (depth[~exists] == np.float32(1e10)).all()
    assert not normal[~exists].any()
    assert np.linalg.norm(normal[exists], axis=1) == pytest.approx(1.0, abs=1e-4)
    assert normal[exists][:, 2].max() == pytest.approx(1.0, abs=1e-3)


def test_statistics_are_plain_numbers(worker):
    job = worker.start(request(), "client")
    assert wait_for_end(job)
    statistics = job.statistics
    assert set(statistics) == {
        "passes",
        *COUNTS,
        "triangles",
        "samples",
        "seconds",
        "error",
        "stopped_by",
    }
    assert 0 < statistics["triangles_drawn"] <= statistics["triangles"] == 12 * 8**2 + 12 * 3**2
    assert statistics["virtual_lights"] == 0 < statistics["triangles_drawn"]  # by rays
    assert statistics["samples"] == 1
    assert statistics["bytes_uploaded"] > 0
    assert all(set(row) == {"drawn", "reused", "skipped", "ms"} for row in statistics["passes"].values())


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


def test_many_jobs_in_a_row_all_end(worker):
    """As while a slider is dragged: most are replaced before the worker begins them."""
    jobs = [worker.start(request(LONG), "client") for _ in range(40)]
    last = worker.start(request(), "client")
    assert wait_for_end(last)
    assert last.error == ""
    assert all(wait_for_end(job, 5.0) for job in jobs)


def test_the_replacing_job_has_its_own_picture(worker, device):
    """Nothing drawn for the older job may be reused by mistake for the newer one."""
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
    requests = [request(settings), request(settings, pillar_field)]
    jobs = [worker.start(each, client) for client, each in enumerate(requests)]
    for job, each in zip(jobs, requests, strict=True):
        assert wait_for_end(job)
        assert np.array_equal(job.picture().color, draw(device, each.scene, each.view, settings).color)


def test_a_long_job_does_not_block_another_client(worker):
    long = worker.start(request(LONG), "final render")
    assert wait_for_picture(long)
    short = worker.start(request(), "viewport")
    assert wait_for_end(short)
    assert not long.finished


def test_the_picture_is_the_same_object_until_there_is_a_newer_one(worker):
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


def test_stop_ends_all_jobs_and_a_later_start_restarts_the_thread(worker):
    jobs = [worker.start(request(LONG), client) for client in "abc"]
    worker.stop()
    assert all(job.finished for job in jobs)
    worker.stop()
    job = worker.start(request(), "a")
    assert wait_for_end(job)
    assert job.picture() is not None


def test_a_start_while_another_thread_stops(worker):
    """In whichever order they take effect, neither waits forever."""
    for _ in range(10):
        worker.start(request(LONG), "client")
        stopping = threading.Thread(target=worker.stop, daemon=True)
        stopping.start()
        job = worker.start(request(), "other")
        stopping.join(20.0)
        assert not stopping.is_alive()
        assert wait_for_end(job)


def test_a_request_that_cannot_be_drawn_is_an_error_of_that_job_only(worker):
    broken = worker.start(request(replace(SMALL_SETTINGS, debug_view="nonsense")), "one")
    valid = worker.start(request(), "two")
    assert wait_for_end(broken)
    assert wait_for_end(valid)
    assert "nonsense" in broken.error
    assert broken.picture() is None
    assert valid.error == ""
    assert wait_for_end(worker.start(request(), "one"))


def with_brighter_lights(scene: Scene) -> Scene:
    return replace(scene, lights=replace(scene.lights, emission=3.0 * scene.lights.emission))


def with_darker_materials(scene: Scene) -> Scene:
    return replace(scene, materials=replace(scene.materials, base_color=0.1 * scene.materials.base_color))


@pytest.mark.parametrize(
    ("pass_type", "change"),
    [(UploadLights, with_brighter_lights), (UploadMaterials, with_darker_materials)],
    ids=["UploadLights", "UploadMaterials"],
)
def test_the_picture_after_a_failed_one_is_that_of_a_new_renderer(worker, device, monkeypatch, pass_type, change):
    """Resources that the failed picture replaced are not reused for the client's earlier picture."""
    requested = request(with_quality(SMALL_SETTINGS, samples=2), size=(48, 32))
    other = replace(requested, scene=change(requested.scene))
    assert wait_for_end(worker.start(requested, "client"))
    execute = pass_type.execute

    def execute_and_fail(own, frame):
        execute(own, frame)
        raise RuntimeError("broken")

    with monkeypatch.context() as patch:
        patch.setattr(pass_type, "execute", execute_and_fail)
        failed = worker.start(other, "client")
        assert wait_for_end(failed)
    assert failed.error == "The picture could not be drawn: broken"
    again = worker.start(requested, "client")
    assert wait_for_end(again)
    assert np.array_equal(
        again.picture().color, draw(device, requested.scene, requested.view, requested.settings).color
    )


def test_wait_returns_whether_there_is_an_update_or_times_out(worker):
    job = worker.start(request(), "client")
    assert wait_for_end(job)
    job.wait(0.0)
    assert job.wait(0.0)  # finished: never waits again
    idle = Job(request(), threading.Condition())
    assert not idle.wait(0.01)


def test_opengl_is_opened_before_the_first_request(worker, monkeypatch):
    """Once: later requests use the same device."""
    opened = threading.Semaphore(0)
    open_device = context.open_device

    def open_and_count() -> context.Device:
        device = open_device()
        opened.release()
        return device

    monkeypatch.setattr(context, "open_device", open_and_count)
    worker.expect()
    assert opened.acquire(timeout=30.0)
    worker.expect()
    assert wait_for_end(worker.start(request(), "client"))
    assert not opened.acquire(blocking=False)
