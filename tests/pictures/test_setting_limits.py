# SPDX-License-Identifier: GPL-3.0-or-later
"""Budgets of nothing and absurd ones: told in a sentence each, and not obeyed."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest

from ism_addon import snapshot
from ism_addon.gpu.jobs.job import Request
from ism_addon.setting_limits import beyond_limits, within_limits
from ism_addon.settings import SECTIONS, Quality, Settings, setting_fields
from tests.scenes.small import box_over_plane
from tests.support.jobs import wait_for_end, wait_for_picture
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw

NUMBERS = [
    pytest.param(name, member, control, id=member.name)
    for name, section in SECTIONS.items()
    for member, control in setting_fields(section)
    if control.low is not None
]

NOTHING = Quality(samples=0, virtual_lights=0, map_size=0, map_points=0)
ABSURD = Quality(samples=10**9, virtual_lights=10**6, map_size=10**5, map_points=10**9)
BUDGETS = [member.name for member in fields(Quality) if member.name in vars(ABSURD) and member.type is int]


def with_value(section: str, name: str, value: float) -> Settings:
    return replace(Settings(), **{section: replace(getattr(Settings(), section), **{name: value})})


@pytest.mark.parametrize("settings", [Settings(), SMALL_SETTINGS, SMALL_SHADOW_MAPS])
def test_what_is_in_its_range_stays_as_it_is(settings):
    assert within_limits(settings) == settings
    assert beyond_limits(settings) == ()


@pytest.mark.parametrize(("section", "member", "control"), NUMBERS)
def test_each_number_has_two_ends(section, member, control):
    for value, end in ((control.low - 1, control.low), (2 * control.high + 1, control.high), (math.nan, control.low)):
        asked = with_value(section, member.name, value)
        found = getattr(getattr(within_limits(asked), section), member.name)
        assert found == end
        (sentence,) = beyond_limits(asked)
        assert sentence == f"{control.label} cannot be {value:,}: {end:,} is used instead."
        assert beyond_limits(within_limits(asked)) == ()


@pytest.mark.parametrize(("section", "member", "control"), NUMBERS)
def test_the_ends_themselves_are_in_the_range_as_blender_has_them(section, member, control):
    for end in (control.low, control.high):
        value = end if member.type is int else float(np.float32(end))
        assert beyond_limits(with_value(section, member.name, value)) == ()


def test_each_budget_has_a_sentence():
    assert len(BUDGETS) == 4
    for quality in (NOTHING, ABSURD):
        assert len(beyond_limits(Settings(quality=quality))) == len(BUDGETS)


def test_budgets_of_nothing_draw_a_picture(worker, device):
    for settings in (SMALL_SETTINGS, SMALL_SHADOW_MAPS):
        job = worker.start(Request(*box_over_plane(24, 16), replace(settings, quality=NOTHING)), "script")
        assert wait_for_end(job)
        assert (job.error, job.samples, job.samples_done) == ("", 1, 1)
        least = replace(settings, quality=Quality(samples=1, virtual_lights=1, map_size=8, map_points=1))
        assert np.array_equal(job.picture().color, draw(device, *box_over_plane(24, 16), least).color)


@pytest.mark.parametrize("name", BUDGETS)
def test_an_absurd_budget_is_begun_and_can_be_cancelled(worker, name):
    quality = replace(SMALL_SHADOW_MAPS.quality, **{"virtual_lights": 1, name: getattr(ABSURD, name)})
    job = worker.start(Request(*box_over_plane(24, 16), replace(SMALL_SHADOW_MAPS, quality=quality)), "script")
    assert wait_for_picture(job)
    job.cancel()
    assert wait_for_end(job)
    assert (job.error, job.samples) == ("", within_limits(replace(SMALL_SHADOW_MAPS, quality=quality)).quality.samples)


def test_a_snapshot_brings_them_too(tmp_path, worker):
    path = tmp_path / "scene.npz"
    snapshot.save(path, *box_over_plane(24, 16), replace(SMALL_SHADOW_MAPS, quality=NOTHING))
    scene, view, settings = snapshot.load(path)
    assert settings.quality == NOTHING
    job = worker.start(Request(scene, view, settings), "script")
    assert wait_for_end(job)
    assert job.picture() is not None
