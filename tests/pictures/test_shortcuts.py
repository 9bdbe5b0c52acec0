# SPDX-License-Identifier: GPL-3.0-or-later
"""Shortcuts skip or reuse work: the counts of that, and that the picture does not change."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.profile import Profile
from tests.scenes.shortcuts import Case, Picture, cases
from tests.support.small_scenes import draw, with_quality

SIZE = 48, 32
#: Fewer than in the benchmark: without shortcuts, each is drawn in each sample.
IDLE_LIGHTS = 60


def with_small_maps(picture: Picture) -> Picture:
    """The picture with fewer and coarser shadow maps."""
    scene, view, settings = picture
    return scene, view, with_quality(settings, virtual_lights=16, map_size=64, map_points=4096)


CASES = {
    case.name: replace(
        case, picture=with_small_maps(case.picture), before=with_small_maps(case.before) if case.before else None
    )
    for case in cases(*SIZE, IDLE_LIGHTS)
}
EACH_CASE = pytest.mark.parametrize("name", CASES, scope="module")  # both tests of a case run in succession
#: Bound of the error over the mean: of what is culled, and of the noise of 16 samples, which differ.
MAX_ERROR = 0.02


@pytest.fixture(scope="module")
def finished() -> dict[str, tuple[Profile, np.ndarray]]:
    """A cache of the profile and the picture of each case."""
    return {}


@pytest.fixture
def drawn(device, finished) -> Callable[[Case], tuple[Profile, np.ndarray]]:
    """drawn(case): its profile and picture, drawn after the case's previous picture. Both tests share them."""

    def drawn(case: Case) -> tuple[Profile, np.ndarray]:
        if case.name not in finished:
            renderer = draw(device, *case.before).renderer if case.before else None
            result = draw(device, *case.picture, renderer)
            finished[case.name] = result.profile, result.color[..., :3]
            result.renderer.release()
        return finished[case.name]

    return drawn


@EACH_CASE
def test_counts(drawn, name):
    case = CASES[name]
    profile, _ = drawn(case)
    passes = {name for name, row in profile.rows.items() if row.drawn}
    assert case.drawn is None or passes == case.drawn
    assert not passes & case.never
    for count, value in case.equal.items():
        assert profile.counts[count] == value, count
    for count, value in case.at_most.items():
        assert profile.counts[count] <= value, count


@EACH_CASE
def test_without_shortcuts_it_is_the_same_picture(device, drawn, name):
    case = CASES[name]
    scene, view, settings = case.picture
    expected = draw(device, scene, view, replace(settings, shortcuts=False)).color[..., :3]
    _, color = drawn(case)
    assert np.sqrt(((color - expected) ** 2).mean()) <= MAX_ERROR * max(expected.mean(), 1e-6)
