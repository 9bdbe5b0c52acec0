# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles is of the same opinion about scenes at their ends, as Blender holds them."""

import pytest

from ism_addon.settings import SSAO, Quality, Settings

from ..scenes.cycles import direct_light
from ..studio import draw
from .cases import CASES
from .into_blender import into_blender, out_of_blender
from .pictures import apart

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
