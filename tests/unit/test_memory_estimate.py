# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory estimate made before a picture is drawn: against what it takes, and the error where too little is free."""

import re
import sys
from dataclasses import replace

import numpy as np
import pytest

from ism_addon import snapshot
from ism_addon.gpu import memory_estimate
from ism_addon.gpu.jobs.job import Request
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import Lights
from ism_addon.settings import SSAO
from tests.scenes.small import box_over_plane
from tests.support.jobs import request, wait_for_end
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw, with_quality

LARGE_MAPS = with_quality(SMALL_SHADOW_MAPS, virtual_lights=40, map_size=256)


@pytest.mark.parametrize(
    "settings", [SMALL_SETTINGS, SMALL_SHADOW_MAPS, LARGE_MAPS], ids=["rays", "maps", "large maps"]
)
@pytest.mark.parametrize("filter_width", [0.01, 1.5, 20.0])
def test_the_estimate_is_what_a_picture_takes(device, monkeypatch, settings, filter_width):
    """Render targets only, whose bytes are counted: textures per light and images being read back are subtracted."""
    calls, estimate = [], memory_estimate.needed
    monkeypatch.setattr("ism_addon.gpu.memory_estimate.needed", lambda *args: calls.append(args) or estimate(*args))
    scene, view = box_over_plane(256, 160)
    view = replace(view, filter_width=filter_width)
    drawn = draw(device, scene, view, replace(with_quality(settings, samples=4), ssao=SSAO()))
    (pass_types, view, fine_pixels, lights, map_texels), *_ = calls
    assert lights == (1 if settings is SMALL_SETTINGS else 0)
    others = memory_estimate.TARGETS_PER_LIGHT * lights + memory_estimate.FULL_SIZE_IMAGES
    needed = memory_estimate.needed(pass_types, view, fine_pixels, lights, map_texels)
    needed -= others * view.width * view.height
    assert needed == pytest.approx(drawn.profile.counts["render_target_bytes"], rel=0.1)


@pytest.mark.skipif(sys.platform != "linux", reason="free memory is read as on Linux")
def test_a_picture_that_needs_more_memory_than_is_free_is_refused(worker, tmp_path):
    """A small snapshot with many lights and the largest picture that OpenGL allows. The next picture is drawn."""
    scene, view = box_over_plane(16, 16)
    many = Lights(**{name: np.repeat(value, 1000, axis=0) for name, value in vars(scene.lights).items()})
    path = tmp_path / "scene.npz"
    snapshot.save(path, replace(scene, lights=many), replace(view, width=16384, height=16384), SMALL_SETTINGS)
    assert path.stat().st_size < 1_000_000
    job = worker.start(Request(*snapshot.load(path)), "client")
    assert wait_for_end(job)
    assert job.error.startswith("The picture could not be drawn: 16384×16384 pixels under 1000 lights that cast")
    assert re.search(r"take 3\d{3}\.\d GB of memory, of which [\d.]+ GB are free: a smaller picture .*$", job.error)
    assert wait_for_end(job := worker.start(request(), "client"))
    assert job.error == ""


def test_memory_that_is_already_allocated_is_not_counted_again(device, monkeypatch):
    """A picture is drawn again although no memory is free."""
    scene, view = box_over_plane(64, 40)
    renderer = Renderer(device)
    draw(device, scene, view, SMALL_SETTINGS, renderer)
    monkeypatch.setattr(
        memory_estimate,
        "NEGLIGIBLE_BYTES",
        (memory_estimate.TARGETS_PER_LIGHT + memory_estimate.FULL_SIZE_IMAGES + 50) * 64 * 40,
    )
    monkeypatch.setattr(memory_estimate, "free", lambda _gl: 0)
    draw(device, scene, view, SMALL_SETTINGS, renderer)
    with pytest.raises(MemoryError, match="128×40 pixels take"):
        next(renderer.sample(scene, replace(view, width=128), SMALL_SETTINGS, 0, Profile()))
