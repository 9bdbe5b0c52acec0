# SPDX-License-Identifier: GPL-3.0-or-later
"""Light and shadow linking: only linked objects are lit, and only linked objects cast shadows."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.culling import culling_state
from ism_addon.scene import MAX_LINK_GROUPS
from ism_addon.settings import Method
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    join_lights,
    light,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)

SETTINGS = {Method.RAY_TRACED: with_quality(SMALL_SETTINGS, samples=8), Method.SHADOW_MAPS: SMALL_SHADOW_MAPS}
LEFT, RIGHT = quad((-2, -2, 0), (2, 0, 0), (0, 4, 0)), quad((0, -2, 0), (2, 0, 0), (0, 4, 0))
LIDS = [quad((x, -2, 1.0), (2, 0, 0), (0, 4, 0)) for x in (-2, 0)]
VIEW = view_from_above(3.0, (64, 48), height=0.8)
#: Link groups of the floor's two halves and of the two lids: the first four possible groups or the last.
GROUPS = pytest.mark.parametrize("groups", [range(4), range(MAX_LINK_GROUPS - 4, MAX_LINK_GROUPS)], ids=str)


def half_radiances(device, settings, lights, groups: range = range(4)) -> tuple[float, float]:
    """The mean radiance of the floor's left and right halves. Each half and each half's lid is a link group."""
    scene = make_scene([LEFT, RIGHT, *LIDS], lights)
    bits = np.array([1 << group for group in groups], np.uint32)
    scene = replace(scene, instances=replace(scene.instances, groups=bits))
    picture = draw(device, scene, VIEW, settings).color[..., 0]
    return picture[:, :30].mean(), picture[:, 34:].mean()


@pytest.fixture(params=Method, ids=[method.label for method in Method])
def settings(request):
    return SETTINGS[request.param]


def small_light(height: float, **links: int):
    """A light so small that it has no visible penumbra."""
    return light(position=(0, 0, height), axis_u=(0.01, 0, 0), axis_v=(0, -0.01, 0), radiance=1e4, **links)


@GROUPS
def test_only_the_linked_are_lit(device, settings, groups):
    left, right, lid, _ = groups
    for group, lit in ((-1, (True, True)), (left, (True, False)), (right, (False, True)), (lid, (False, False))):
        radiances = half_radiances(device, settings, small_light(0.9, receivers=group), groups)
        assert tuple(half > 0.0 for half in radiances) == lit


@GROUPS
def test_only_the_linked_cast_shadows(device, settings, groups):
    floor, _, left, right = groups
    for group, lit in ((-1, (False, False)), (left, (False, True)), (right, (True, False)), (floor, (True, True))):
        radiances = half_radiances(device, settings, small_light(1.5, blockers=group), groups)
        unshadowed = max(half_radiances(device, settings, small_light(1.5, casts_shadow=False)))
        assert tuple(half > 0.5 * unshadowed for half in radiances) == lit


def test_linking_of_faint_lights(device, monkeypatch):
    monkeypatch.setattr(culling_state, "FAINT_FRACTION", np.inf)
    for links, lit in (({"receivers": 0}, (True, False)), ({"receivers": 1}, (False, True))):
        radiances = half_radiances(
            device, SETTINGS[Method.RAY_TRACED], join_lights(small_light(0.9, **links), small_light(0.9, receivers=2))
        )
        assert tuple(half > 0.0 for half in radiances) == lit
