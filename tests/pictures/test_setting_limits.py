# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings beyond their limits are clamped, and each is reported in a sentence."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest

from ism_addon import snapshot
from ism_addon.gpu.jobs.job import Request
from ism_addon.setting_limits import beyond_limits, within_limits
from ism_addon.settings import SECTIONS, Quality, Settings
from ism_addon.settings.setting_fields import setting_fields
from tests.scenes.small import box_over_plane
from tests.support.jobs import wait_for_end, wait_for_picture
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw

NUMERIC_SETTINGS = [
    pytest.param(name, member, control, id=member.name)
    for name, section in SECTIONS.items()
    for member, control in setting_fields(section)
    if control.low is not None
]

ZERO_QUALITY = Quality(samples=0, virtual_lights=0, map_size=0, map_points=0)
HUGE_QUALITY = Quality(samples=10**9, virtual_lights=10**6, map_size=10**5, map_points=10**9)
COUNT_SETTINGS = [member.name for member in fields(Quality) if member.name in vars(HUGE_QUALITY) and member.type is int]


def with_value(section: str, name: str, value: float) -> Settings:
    return replace(Settings(), **{section: replace(getattr(Settings(), section), **{name: value})})


@pytest.mark.parametrize("settings", [Settings(), SMALL_SETTINGS, SMALL_SHADOW_MAPS])
def test_settings_in_their_ranges_are_unchanged(settings):
    assert within_limits(settings) == settings
    assert beyond_limits(settings) == ()


@pytest.mark.parametrize(("section", "member", "control"), NUMERIC_SETTINGS)
def test_each_number_is_clamped_at_both_limits(section, member, control):
    for value, limit in ((control.low - 1, control.low), (2 * control.high + 1, control.high), (math.nan, control.low)):
        requested = with_value(section, member.name, value)
        clamped = getattr(getattr(within_limits(requested), section), member.name)
        assert clamped == limit
        (sentence,) = beyond_limits(requested)
        assert sentence == f"{control.label} cannot be {value:,}: {limit:,} is used instead."
        assert beyond_limits(within_limits(requested)) == ()


@pytest.mark.parametrize(("section", "member", "control"), NUMERIC_SETTINGS)
def test_the_limits_are_in_the_range_as_float32_in_blender(section, member, control):
    for limit in (control.low, control.high):
        value = limit if member.type is int else float(np.float32(limit))
        assert beyond_limits(with_value(section, member.name, value)) == ()


def test_each_count_has_a_sentence():
    assert len(COUNT_SETTINGS) == 4
    for quality in (ZERO_QUALITY, HUGE_QUALITY):
        assert len(beyond_limits(Settings(quality=quality))) == len(COUNT_SETTINGS)


def test_counts_of_zero_draw_a_picture(worker, device):
    for settings in (SMALL_SETTINGS, SMALL_SHADOW_MAPS):
        job = worker.start(Request(*box_over_plane(24, 16), replace(settings, quality=ZERO_QUALITY)), "script")
        assert wait_for_end(job)
        assert (job.error, job.samples, job.samples_done) == ("", 1, 1)
        minimum = replace(settings, quality=Quality(samples=1, virtual_lights=1, map_size=8, map_points=1))
        assert np.array_equal(job.picture().color, draw(device, *box_over_plane(24, 16), minimum).color)


@pytest.mark.parametrize("name", COUNT_SETTINGS)
def test_a_huge_count_is_drawn_and_can_be_cancelled(worker, name):
    quality = replace(SMALL_SHADOW_MAPS.quality, **{"virtual_lights": 1, name: getattr(HUGE_QUALITY, name)})
    job = worker.start(Request(*box_over_plane(24, 16), replace(SMALL_SHADOW_MAPS, quality=quality)), "script")
    assert wait_for_picture(job)
    job.cancel()
    assert wait_for_end(job)
    assert (job.error, job.samples) == ("", within_limits(replace(SMALL_SHADOW_MAPS, quality=quality)).quality.samples)


def test_settings_of_a_snapshot_are_clamped(tmp_path, worker):
    path = tmp_path / "scene.npz"
    snapshot.save(path, *box_over_plane(24, 16), replace(SMALL_SHADOW_MAPS, quality=ZERO_QUALITY))
    scene, view, settings = snapshot.load(path)
    assert settings.quality == ZERO_QUALITY
    job = worker.start(Request(scene, view, settings), "script")
    assert wait_for_end(job)
    assert job.picture() is not None
