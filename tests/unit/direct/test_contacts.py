# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that nearly touch: rays start no farther from one than float32 requires, a millionth of the coordinates."""

from dataclasses import replace

import numpy as np
import pytest

from tests.support.small_scenes import (
    SMALL_SETTINGS,
    draw,
    light,
    make_scene,
    quad,
    transform,
    view_from_above,
    with_quality,
)

SETTINGS = with_quality(SMALL_SETTINGS, samples=4)


def picture(device, offset: float, gap: float, settings=SETTINGS):
    """(H,W,3): a floor at `offset` m in x and y, with a sheet `gap` m above it that the camera does not see."""
    floor, sheet = (
        quad((offset - size / 2.0, offset - size / 2.0, height), (size, 0.0, 0.0), (0.0, size, 0.0))
        for size, height in ((2.0, 0.0), (1.6, gap))
    )
    scene = make_scene([floor, sheet], light(position=(offset, offset, 2.0)))
    scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
    view = view_from_above(1.0, (16, 16), height=1.0)
    view = replace(view, view_from_world=view.view_from_world @ transform(offset=(-offset, -offset, 0.0)))
    return draw(device, scene, view, settings).color[..., :3]


@pytest.mark.parametrize("offset", [0.0, 1.0, 10.0])
@pytest.mark.parametrize("gap", [5e-6, 2e-5, 1e-3])
def test_a_sheet_right_above_the_floor_occludes_all_light(device, offset, gap):
    assert not picture(device, offset, gap).any()


@pytest.mark.parametrize("offset", [0.0, 1.0, 10.0])
def test_a_sheet_right_below_the_floor_occludes_no_light(device, offset):
    without_shadows = replace(SETTINGS, shadow=replace(SETTINGS.shadow, enabled=False))
    shadowed, unshadowed = (picture(device, offset, -2e-5, settings) for settings in (SETTINGS, without_shadows))
    assert unshadowed.min() > 0.0
    assert shadowed == pytest.approx(unshadowed, rel=1e-5)
