# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts the OpenGL calls of an ordinary sample: each takes the driver time, however small the picture."""

import math
import platform
import sys
import time
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu import submission
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from tests.scenes.small import box_over_plane
from tests.support import gl_calls
from tests.support.small_scenes import SMALL_SETTINGS, join_lights, with_quality

pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or platform.machine() not in gl_calls.STUBS, reason="counts by machine code, under Linux"
)

#: Samples between doublings, which allocate, read back and estimate nothing.
ORDINARY = range(20, 28)


@pytest.fixture
def counted(monkeypatch):
    """A device, and the counter of its OpenGL calls."""
    opened = gl_calls.count_calls(monkeypatch)
    device = open_device()
    yield device, opened[0]
    device.close()


@pytest.fixture
def samples(counted):
    """samples(): calls of each ordinary sample of a picture with six lights, its profile, and its seconds."""
    device, calls = counted
    scene, view = box_over_plane(64, 36)
    lights = one = scene.lights
    for index in range(5):
        position = one.position + np.array([0.3 * index - 0.7, 0.2 * index, 0.1])
        lights = join_lights(lights, replace(one, position=position))
    scene, view = replace(scene, lights=lights), replace(view, filter_width=1.5)
    settings = with_quality(SMALL_SETTINGS, samples=64)

    def samples() -> tuple[list[Counter], Profile, float]:
        renderer, counts = Renderer(device), []
        for sample in range(ORDINARY.stop):
            if sample == ORDINARY.start:
                renderer.submission.finish()
                profile, start = Profile(), time.perf_counter()
            before = calls.counts
            list(renderer.sample(scene, view, settings, sample, profile if sample in ORDINARY else Profile()))
            counts.append(calls.counts - before)
        renderer.submission.finish()
        assert all(count["glDrawArraysInstanced"] > 10 for count in counts), "nothing was drawn or counted"
        return [counts[sample] for sample in ORDINARY], profile, time.perf_counter() - start

    return samples


def waits(calls: Counter) -> int:
    return sum(calls[name] for name in gl_calls.WAITS)


def test_an_ordinary_sample_makes_few_calls(samples, monkeypatch):
    monkeypatch.setattr(submission, "SHORT_SAMPLE", math.inf)  # however busy the machine is
    for count in samples()[0][1:]:
        assert gl_calls.objects_created(count) == 0, count
        assert waits(count) == 1, count
        assert sum(count.values()) <= 400, count


def test_a_long_sample_is_waited_for_pass_by_pass(samples, monkeypatch):
    """Otherwise a cancellation would take effect only at its end."""
    monkeypatch.setattr(submission, "SHORT_SAMPLE", 0.0)
    counts, profile, _ = samples()
    assert sum(waits(count) for count in counts) >= sum(row.drawn for row in profile.rows.values())


@pytest.mark.parametrize("short", [0.0, math.inf])
def test_the_times_of_passes_add_up_to_that_of_their_samples(samples, opened_device, monkeypatch, short):
    """Whether each pass is waited for or not. On a graphics card a sample this small takes Python longer."""
    monkeypatch.setattr(submission, "SHORT_SAMPLE", short)
    _, profile, seconds = samples()
    drawn = [row for row in profile.rows.values() if row.drawn]
    assert len(drawn) > 5
    assert all(row.ms > 0.0 for row in drawn)
    least = 0.3 * seconds if opened_device.name.startswith("llvmpipe") else 0.0
    assert least < 1e-3 * sum(row.ms for row in drawn) <= 1.01 * seconds
