# SPDX-License-Identifier: GPL-3.0-or-later
"""The counts of what is left out, or taken from the picture before; and that it changes no picture."""

from dataclasses import replace

import numpy as np
import pytest

from tests.scenes.shortcuts import Case, cases
from tests.support.small_scenes import draw

SIZE = 160, 96
CASES = {case.name: case for case in cases(*SIZE)}
#: Of what is left out, and of the noise that is left after 16 samples, which are others, as a part of the mean.
LEFT_OUT = 0.02


def drawn(device, case: Case):
    """A case's picture, after the one before it."""
    renderer = draw(device, *case.before).renderer if case.before else None
    return draw(device, *case.picture, renderer)


@pytest.mark.parametrize("name", CASES)
def test_counts(device, name):
    case = CASES[name]
    profile = drawn(device, case).profile
    passes = {name for name, row in profile.rows.items() if row.drawn}
    assert case.drawn is None or passes == case.drawn
    assert not passes & case.never
    for count, value in case.equal.items():
        assert profile.counts[count] == value, count
    for count, value in case.at_most.items():
        assert profile.counts[count] <= value, count


@pytest.mark.parametrize("name", CASES)
def test_without_skipping_it_is_the_same_picture(device, name):
    case = CASES[name]
    scene, view, settings = case.picture
    whole = draw(device, scene, view, replace(settings, shortcuts=False)).color[..., :3]
    found = drawn(device, case).color[..., :3]
    assert np.sqrt(((found - whole) ** 2).mean()) <= LEFT_OUT * max(whole.mean(), 1e-6)
