# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture stops after its samples, at its error threshold or at its time limit; and how that is reported."""

import math
import threading
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.convergence import Convergence
from ism_addon.gpu.jobs.job import Job, Request
from ism_addon.gpu.jobs.refinement import (
    ERROR_EXPONENT,
    MAX_REFINEMENT,
    MIN_SUFFICIENT_ERROR,
    error_per_sample,
    sufficient_error,
    sufficient_errors,
)
from ism_addon.gpu.jobs.render_loop import draw_job
from ism_addon.gpu.passes.film.estimate_error import MIN_SAMPLES_TO_STOP
from ism_addon.gpu.profile import table
from ism_addon.gpu.renderer import Renderer
from ism_addon.settings import Method, Shadow
from tests.scenes.small import pillar_field
from tests.support.small_scenes import SMALL_SETTINGS, draw, with_quality


@pytest.fixture
def drawn(device):
    """drawn(settings, **quality): draws a picture to its end; the job, and its successive status texts."""
    renderers = Renderer(device), Renderer(device)

    def drawn(
        settings=SMALL_SETTINGS, preview_pixel_size: int = 1, size=(48, 32), **quality: float
    ) -> tuple[Job, list[str]]:
        job = Job(
            Request(*pillar_field(*size), with_quality(settings, **quality), preview_pixel_size=preview_pixel_size),
            threading.Condition(),
        )
        statuses, progress = [""], 0.0
        for _ in draw_job(*renderers, job):
            assert progress <= job.progress <= 1.0
            progress = job.progress
            if statuses[-1] != job.status:
                statuses.append(job.status)
        return job, statuses[1:]

    yield drawn
    for renderer in renderers:
        renderer.release()


def test_all_samples_are_drawn_if_nothing_else_stops_it(drawn):
    job, _ = drawn(samples=5)
    assert (job.samples_done, job.statistics["samples"], job.statistics["stopped_by"]) == (5, 5, "samples")


@pytest.mark.parametrize("method", Method)
def test_a_small_error_stops_it(drawn, device, method):
    settings = replace(SMALL_SETTINGS, shadow=Shadow(method=method))
    job, _ = drawn(settings, samples=4096, error_threshold=0.2)
    assert job.statistics["stopped_by"] == "error"
    assert MIN_SAMPLES_TO_STOP <= job.samples_done == job.picture().samples < 4096
    assert job.statistics["error"] < 0.2
    requested = with_quality(settings, samples=4096, error_threshold=0.2)
    assert np.array_equal(
        job.picture().color, draw(device, *pillar_field(48, 32), requested, last=job.samples_done - 1).color
    )


def test_a_lower_threshold_gives_less_error(drawn):
    jobs = [drawn(samples=4096, error_threshold=threshold)[0] for threshold in (0.3, 0.1)]
    assert jobs[0].samples_done < jobs[1].samples_done
    assert jobs[0].statistics["error"] > jobs[1].statistics["error"]


def test_a_picture_that_is_noisy_after_its_samples_has_more(drawn):
    job, statuses = drawn(samples=16)
    assert 16 < job.samples_done <= 16 * MAX_REFINEMENT
    assert job.statistics["error"] <= MIN_SUFFICIENT_ERROR or job.samples_done == 16 * MAX_REFINEMENT
    assert job.statistics["stopped_by"] in ("samples", "error")
    assert statuses[3].startswith("Sample 3/16")
    assert any(status.startswith(f"Sample 12/{16 * MAX_REFINEMENT}, error") for status in statuses)
    assert statuses[-1].startswith(f"Sample {job.samples_done}/{job.samples_done}, error")


def test_tiles_with_little_noise_have_no_more(drawn):
    refined, _ = drawn(samples=64, size=(96, 64))
    requested, _ = drawn(samples=refined.samples_done, size=(96, 64))
    assert 64 < refined.samples_done <= requested.samples_done
    assert refined.statistics["pixels_drawn"] < 0.95 * requested.statistics["pixels_drawn"]
    assert refined.statistics["error"] <= MIN_SUFFICIENT_ERROR


def test_the_sufficient_error_has_the_least_sum_with_the_time():
    quality = with_quality(SMALL_SETTINGS, samples=16, error_threshold=0.0).quality
    samples = np.geomspace(1.0, 1e6, 20_000)
    for tiles, lights, first in ((10_000, 1.0, 1.0), (10_000, 4.0, 1.0), (40_000, 2.0, 3.0)):
        error = first * samples**-ERROR_EXPONENT
        best = int(np.argmin(error + error_per_sample(tiles, lights) * samples))
        assert sufficient_error(quality, tiles, lights, samples[best]) == pytest.approx(error[best], rel=2e-3)
    assert sufficient_error(quality, 1, 1.0, 16) == MIN_SUFFICIENT_ERROR


def test_tiles_that_dominate_the_error_go_on_and_even_ones_as_their_picture():
    quality = with_quality(SMALL_SETTINGS, samples=16, error_threshold=0.0).quality
    error = Convergence((100, 100))
    error.counts[:] = 16.0
    error.variance = np.full(error.counts.shape, 16.0, np.float32)
    even = sufficient_error(quality, error.counts.size, 1.0, 16)
    error.variance *= even**2
    assert sufficient_errors(quality, error, 1.0) == pytest.approx(even)
    error.variance[:10] *= 100.0
    sufficient = sufficient_errors(quality, error, 1.0)
    tile_errors = np.sqrt(error.variance / error.counts)
    assert (tile_errors[:10] > sufficient[:10]).all() and (tile_errors[10:] < sufficient[10:]).all()


@pytest.mark.parametrize(
    "settings, quality",
    [
        pytest.param(SMALL_SETTINGS, {"samples": 15}, id="few samples"),
        pytest.param(SMALL_SETTINGS, {"samples": 2048}, id="little noise"),
        pytest.param(SMALL_SETTINGS, {"samples": 16, "error_threshold": 0.2}, id="noise that the user accepts"),
        pytest.param(replace(SMALL_SETTINGS, shortcuts=False), {"samples": 16}, id="without shortcuts"),
        pytest.param(
            replace(SMALL_SETTINGS, shadow=Shadow(method=Method.SHADOW_MAPS)), {"samples": 16}, id="shadow maps"
        ),
    ],
)
def test_other_pictures_have_the_requested_samples(drawn, settings, quality):
    job, _ = drawn(settings, **quality)
    assert job.samples_done == job.samples == quality["samples"]


@pytest.mark.parametrize("preview_pixel_size", [1, 4])
def test_one_sample_is_drawn_however_short_the_time_limit(drawn, preview_pixel_size):
    job, _ = drawn(samples=4096, time_limit=1e-9, preview_pixel_size=preview_pixel_size)
    assert (job.samples_done, job.picture().samples, job.statistics["stopped_by"]) == (1, 1, "time")


def test_no_sample_begins_after_the_time_limit(drawn):
    job, _ = drawn(samples=65536, time_limit=0.5)
    assert job.statistics["stopped_by"] == "time"
    assert 1 < job.samples_done < 65536
    assert job.picture().samples == job.samples_done
    assert job.statistics["seconds"] >= 0.5


def test_a_long_time_limit_stops_nothing(drawn):
    assert drawn(samples=3, time_limit=1e6)[0].statistics["stopped_by"] == "samples"


def test_the_error_is_reported_from_two_samples_on(drawn):
    job, statuses = drawn(samples=3)
    assert statuses[:2] == ["Sample 0/3", "Sample 1/3"]
    assert statuses[-1] == f"Sample 3/3, error {100.0 * job.statistics['error']:.1f} %"
    assert math.isinf(drawn(samples=1)[0].statistics["error"])


def test_the_table_says_what_stopped_it(drawn):
    assert "stopped by time" in table(drawn(samples=9, time_limit=1e-9)[0].statistics)
    assert "error" not in table(drawn(samples=1)[0].statistics)
    job, _ = drawn(samples=2)
    text = table(job.statistics)
    assert "stopped by samples" in text
    assert f"estimated error {100.0 * job.statistics['error']:.2f} %" in text
