# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark's renderer that is told where each light is seen in part: it draws the same picture by fewer looks."""

from dataclasses import replace

import numpy as np

from ism_addon.gpu.passes.light_selection import probe_visibility
from ism_addon.gpu.profile import Profile
from ism_addon.resources import LIGHT_INFLUENCE
from tests.benchmark.known import tell
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS, draw, with_quality


def test_told_it_looks_at_less_and_draws_the_same(device, monkeypatch):
    (scene, view), settings = box_over_plane(128, 96), with_quality(SMALL_SETTINGS, samples=16)
    first = draw(device, scene, view, settings, last=0)
    renderer = draw(device, scene, view, settings).renderer
    tell(renderer)
    probed, trace_tiles = [], probe_visibility.trace_tiles
    counted = lambda *given: (probed.append(len(given[2])), trace_tiles(*given))  # noqa: E731
    monkeypatch.setattr(probe_visibility, "trace_tiles", counted)
    beside = replace(view, clip_from_view=(1.0 + 1e-6) * view.clip_from_view)  # or what is there would do
    for sample in range(16):
        for _ in renderer.sample(scene, beside, settings, sample, Profile()):
            pass
        if sample == 0:
            assert np.abs(renderer.picture() - first.color).mean() < 1e-3 * first.color.mean()
    assert 0 < sum(probed) < 0.7 * sum(to.to_probe.sum() for to in first.renderer.graph[LIGHT_INFLUENCE].values())
    assert np.abs(renderer.picture() - draw(device, scene, view, settings).color).mean() < 5e-3 * first.color.mean()
