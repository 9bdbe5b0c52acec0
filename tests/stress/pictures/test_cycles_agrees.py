# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles is of the same opinion about scenes at their ends, as Blender holds them."""

import pytest

from ism_addon.settings import SSAO, Quality, Settings
from tests.scenes.cycles import direct_light
from tests.stress.pictures.cases import CASES
from tests.stress.pictures.comparisons import apart
from tests.stress.pictures.into_blender import into_blender, out_of_blender
from tests.support.small_scenes import draw

SETTINGS = Settings(ssao=SSAO(enabled=False), quality=Quality(samples=512, error_threshold=0.0))
FILTER = 1.5  # px


@pytest.mark.parametrize("name", CASES)
def test_cycles_agrees(device, within, name):
    """But for the noise of both."""
    into_blender(*CASES[name]())
    truth = direct_light(1024, FILTER)
    scene, view = out_of_blender()
    assert not scene.warnings
    within(apart(draw(device, scene, view, SETTINGS).color, truth), 0.05)
