# SPDX-License-Identifier: GPL-3.0-or-later
"""The counts of what is left out, or taken from the picture before; and that it changes no picture."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.profile import Profile
from tests.scenes.shortcuts import Case, Picture, cases
from tests.support.small_scenes import draw, with_quality

SIZE = 48, 32


def with_small_maps(picture: Picture) -> Picture:
    """The same by fewer and coarser shadow maps."""
    scene, view, settings = picture
    return scene, view, with_quality(settings, virtual_lights=16, map_size=64, map_points=4096)


CASES = {
    case.name: replace(
        case, picture=with_small_maps(case.picture), before=with_small_maps(case.before) if case.before else None
    )
    for case in cases(*SIZE)
}
EACH = pytest.mark.parametrize("name", CASES, scope="module")  # both tests of a case, one after the other
#: Of what is left out, and of the noise that is left after 16 samples, which are others, as a part of the mean.
LEFT_OUT = 0.02


@pytest.fixture(scope="module")
def finished() -> dict[str, tuple[Profile, np.ndarray]]:
    """Of cases that have been drawn: what was done, and the picture."""
    return {}


@pytest.fixture
def drawn(device, finished) -> Callable[[Case], tuple[Profile, np.ndarray]]:
    """drawn(case): its picture, after the one before it. Both tests of a case look at one."""

    def drawn(case: Case) -> tuple[Profile, np.ndarray]:
        if case.name not in finished:
            renderer = draw(device, *case.before).renderer if case.before else None
            found = draw(device, *case.picture, renderer)
            finished[case.name] = found.profile, found.color[..., :3]
            found.renderer.release()
        return finished[case.name]

    return drawn


@EACH
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


@EACH
def test_without_skipping_it_is_the_same_picture(device, drawn, name):
    case = CASES[name]
    scene, view, settings = case.picture
    whole = draw(device, scene, view, replace(settings, shortcuts=False)).color[..., :3]
    _, found = drawn(case)
    assert np.sqrt(((found - whole) ** 2).mean()) <= LEFT_OUT * max(whole.mean(), 1e-6)
