# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of extreme scenes against Cycles, both drawn from the same Blender scene."""

import pytest

from ism_addon.settings import SSAO, Quality, Settings
from tests.scenes.cycles import direct_light
from tests.stress.pictures.cases import CASES
from tests.stress.pictures.comparisons import relative_difference
from tests.stress.pictures.into_blender import into_blender, out_of_blender
from tests.support.small_scenes import draw, with_quality

SETTINGS = Settings(ssao=SSAO(enabled=False), quality=Quality(samples=64, error_threshold=0.0))
FILTER_WIDTH = 1.5  # px

#: With the samples of SETTINGS the relative difference is below 0.041, except in these noisier scenes, which are drawn
#: with this many times as many samples.
SAMPLE_FACTORS = {
    "pillar field": 2,
    "a light with a spread of 0.2": 4,
    "a light a millimetre above a box": 8,
    "light from 0.5 degrees above the floor": 8,
    "a light of 100.0 m": 8,
    "a point ten centimetres above the floor": 4,
    "a spot of 0.1, hard": 16,
    "a spot of 0.3 m": 4,
    "an elliptical spot of 0.2 m": 8,
    "a spot near the ball": 8,
    "a low sun of 0.5": 4,
}


@pytest.mark.parametrize("name", CASES)
def test_cycles_agrees(device, assert_within, name):
    """The bound leaves room for the noise of both renderers."""
    into_blender(*CASES[name]())
    factor = SAMPLE_FACTORS.get(name, 1)
    truth = direct_light(128 * factor, FILTER_WIDTH)
    scene, view = out_of_blender()
    assert not scene.warnings
    settings = with_quality(SETTINGS, samples=factor * SETTINGS.quality.samples)
    assert_within(relative_difference(draw(device, scene, view, settings).color, truth), 0.05)
