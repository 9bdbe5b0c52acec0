# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark's renderer that knows each tile's visibility of each light: the same picture with fewer probes."""

from dataclasses import replace

import numpy as np

from ism_addon.gpu.passes.light_selection import probe_visibility
from ism_addon.gpu.profile import Profile
from ism_addon.resources import LIGHT_INFLUENCE
from tests.benchmark.known import use_known_visibility
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS, draw, with_quality


def test_known_visibility_saves_probes_and_draws_the_same_picture(device, monkeypatch):
    (scene, view), settings = box_over_plane(128, 96), with_quality(SMALL_SETTINGS, samples=16)
    first_sample = draw(device, scene, view, settings, last=0)
    renderer = draw(device, scene, view, settings).renderer
    use_known_visibility(renderer)
    probed, trace_tiles = [], probe_visibility.trace_tiles
    counted = lambda *arguments: (probed.append(len(arguments[2])), trace_tiles(*arguments))  # noqa: E731
    monkeypatch.setattr(probe_visibility, "trace_tiles", counted)
    # Another view: otherwise all passes would reuse their results.
    changed_view = replace(view, clip_from_view=(1.0 + 1e-6) * view.clip_from_view)
    for sample in range(16):
        for _ in renderer.sample(scene, changed_view, settings, sample, Profile()):
            pass
        if sample == 0:
            assert np.abs(renderer.picture() - first_sample.color).mean() < 1e-3 * first_sample.color.mean()
    influences = first_sample.renderer.graph[LIGHT_INFLUENCE].values()
    assert 0 < sum(probed) < 0.7 * sum(influence.to_probe.sum() for influence in influences)
    expected = draw(device, scene, view, settings).color
    assert np.abs(renderer.picture() - expected).mean() < 5e-3 * first_sample.color.mean()
