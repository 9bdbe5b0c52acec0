# SPDX-License-Identifier: GPL-3.0-or-later
"""Each setting changes the picture of exactly those methods that its tooltip names."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.choices import Choice, DebugView
from ism_addon.resources import DEBUG_VIEWS
from ism_addon.settings import SECTIONS, Method, Settings, ViewportQuality
from ism_addon.settings.setting_fields import help_text, setting_fields
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw, with_quality

#: For each setting of light and shadow, a value that changes the picture of its methods.
OTHER_VALUES = {
    "enabled": False,
    "world": True,
    "sky_dome": True,
    "splat_size": 2.5,
    "bias": 8.0,
    "fill_holes": False,
    "fill_threshold": 1.0,
    "samples": 3,
    "virtual_lights": 3,
    "map_size": 16,
    "map_points": 256,
}
SETTINGS_WITH_METHOD = [
    pytest.param(name, member.name, control.method, id=member.name)
    for name in ("shadow", "quality")
    for member, control in setting_fields(SECTIONS[name])
    if member.name not in ("method", "error_threshold", "time_limit")  # the last two stop a picture: see test_ends
]


def changed(settings, section, name):
    return replace(settings, **{section: replace(getattr(settings, section), **{name: OTHER_VALUES[name]})})


@pytest.mark.parametrize(("section", "name", "method"), SETTINGS_WITH_METHOD)
def test_a_setting_affects_the_methods_that_it_names(device, section, name, method):
    scene, view = box_over_plane(48, 32)
    with_holes = with_quality(SMALL_SHADOW_MAPS, map_size=128)
    for settings in (with_quality(SMALL_SETTINGS, samples=2), with_holes):
        plain = draw(device, scene, view, settings).color
        other = draw(device, scene, view, changed(settings, section, name)).color
        assert np.array_equal(plain, other) != (method in (None, settings.shadow.method))


def test_the_methods_draw_different_pictures(device):
    one, other = (
        draw(device, *box_over_plane(48, 32), settings).color for settings in (SMALL_SETTINGS, SMALL_SHADOW_MAPS)
    )
    assert not np.array_equal(one, other)


def test_every_setting_has_a_tooltip():
    for section in (*SECTIONS.values(), ViewportQuality, Settings):
        for member, control in setting_fields(section):
            text = help_text(member, control)
            assert text[0].isupper() and not text.endswith(".")
            assert (". For the method Imperfect Shadow Maps only" in text) == (control.method is Method.SHADOW_MAPS)
            for choice in member.type if issubclass(member.type, Choice) else ():
                assert f"{choice.value}: {choice.meaning}" in text


def test_a_debug_view_is_any_target_that_can_be_shown():
    assert sorted(DebugView) == sorted(view.name for view in DEBUG_VIEWS)
