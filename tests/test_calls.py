# SPDX-License-Identifier: GPL-3.0-or-later
"""What an ordinary sample asks of OpenGL, counted: each call takes a driver time, however small the picture."""

import platform
import sys
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.context import open_device
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer

from . import gl_calls
from .scenes.small import box_over_plane
from .studio import SMALL_SETTINGS, both, with_quality

pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or platform.machine() not in gl_calls.STUBS, reason="counts by machine code, under Linux"
)

#: Samples between doublings, when nothing is made, read back or found out.
ORDINARY = range(20, 28)


@pytest.fixture
def counted(monkeypatch):
    """A device, and how often each function of OpenGL's was called so far."""
    opened = gl_calls.counting(monkeypatch)
    device = open_device()
    yield device, opened[0]
    device.close()


def test_an_ordinary_sample(counted):
    """Of six lights with shadows."""
    device, calls = counted
    scene, view = box_over_plane(64, 36)
    lights = one = scene.lights
    for number in range(5):
        place = one.position + np.array([0.3 * number - 0.7, 0.2 * number, 0.1])
        lights = both(lights, replace(one, position=place))
    scene, view = replace(scene, lights=lights), replace(view, filter_width=1.5)
    settings = with_quality(SMALL_SETTINGS, samples=64)
    renderer, samples = Renderer(device), []
    for sample in range(ORDINARY.stop):
        before = calls.so_far
        list(renderer.sample(scene, view, settings, sample, Profile()))
        samples.append(calls.so_far - before)
    assert all(count["glDrawArraysInstanced"] > 10 for count in samples), "nothing was drawn, or counted"
    for count in (samples[sample] for sample in ORDINARY):
        assert gl_calls.made(count) == 0, count
        assert sum(count.values()) <= 400, count
