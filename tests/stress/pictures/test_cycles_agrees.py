# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles is of the same opinion about scenes at their ends, as Blender holds them."""

import pytest

from ism_addon.settings import SSAO, Quality, Settings
from tests.scenes.cycles import direct_light
from tests.stress.pictures.cases import CASES
from tests.stress.pictures.comparisons import relative_difference
from tests.stress.pictures.into_blender import into_blender, out_of_blender
from tests.support.small_scenes import draw, with_quality

SETTINGS = Settings(ssao=SSAO(enabled=False), quality=Quality(samples=64, error_threshold=0.0))
FILTER = 1.5  # px

#: Of so many samples of ours the two are less than 0.041 apart, but for these, whose noise needs so many times as many.
EFFORTS = {
    "pillar field": 2,
    "a light with a spread of 0.2": 4,
    "a light a millimetre above a box": 8,
    "light from 0.5 degrees above the floor": 8,
    "a light of 100.0 m": 8,
}


@pytest.mark.parametrize("name", CASES)
def test_cycles_agrees(device, within, name):
    """But for the noise of both."""
    into_blender(*CASES[name]())
    effort = EFFORTS.get(name, 1)
    truth = direct_light(128 * effort, FILTER)
    scene, view = out_of_blender()
    assert not scene.warnings
    settings = with_quality(SETTINGS, samples=effort * SETTINGS.quality.samples)
    within(relative_difference(draw(device, scene, view, settings).color, truth), 0.05)
