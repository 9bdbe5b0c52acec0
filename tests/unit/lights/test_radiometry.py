# SPDX-License-Identifier: GPL-3.0-or-later
"""Each factor in radiometry.py against an integral over the light."""

import numpy as np
import pytest

from ism_addon.radiometry import MIN_SPREAD, area_light_radiance, spread_terms
from ism_addon.scene import LightShape
from tests.support.emission import spread_factor
from tests.support.light_grids import irradiance
from tests.support.small_scenes import light


@pytest.mark.parametrize("spread", np.radians([180.0, 179.0, 120.0, 60.0, 10.0]))
def test_a_light_emits_the_watts_it_is_given(spread):
    cosine = (np.arange(200_000) + 0.5) / 200_000
    tangent, scale = spread_terms(np.array([spread]))[0]
    factor = np.maximum(tangent - np.sqrt(1.0 - cosine**2) / cosine, 0.0) * scale if scale else np.ones_like(cosine)
    radiance = area_light_radiance(np.array([10.0, 20.0, 30.0]), 0.5)
    watts = radiance * 0.5 * 2.0 * np.pi * (cosine * factor).mean()
    assert watts == pytest.approx([10.0, 20.0, 30.0], rel=2e-3)
    assert np.allclose(factor, spread_factor(spread, cosine), rtol=1e-6, atol=1e-12)


def test_a_full_spread_has_no_terms_and_a_tiny_one_is_clamped():
    assert not spread_terms(np.array([np.pi, np.pi + 1e-7])).any()
    assert np.array_equal(spread_terms(np.array([0.0])), spread_terms(np.array([MIN_SPREAD])))
    assert np.isfinite(spread_terms(np.linspace(0.0, np.pi, 10_001))).all()


def test_a_narrow_spread_keeps_its_watts():
    """tan(angle) - angle in single precision would lose four digits at 2°."""
    half = np.float64(np.float32(np.radians(2.0))) / 2.0
    series = half**3 * (1.0 / 3.0 + half**2 * (2.0 / 15.0 + half**2 * 17.0 / 315.0))
    assert spread_terms(np.array([2.0 * half], np.float32))[0, 1] == pytest.approx(1.0 / series, rel=1e-6)


def test_the_reference_matches_closed_forms():
    """pi sin² for a disk straight above, inverse square for a far light; both of the reference's methods are used."""
    up = np.array([0.0, 0.0, 1.0])
    for height in (0.05, 0.4, 1.4, 1.6, 5.0):
        lights = light(LightShape.ELLIPSE, (0.0, 0.0, height))
        assert irradiance(np.zeros(3), up, lights, 0) == pytest.approx(np.pi * 0.25 / (0.25 + height**2), rel=2e-3)
    far = light(LightShape.RECTANGLE, (0.0, 0.0, 1000.0))
    assert irradiance(np.zeros(3), up, far, 0) == pytest.approx(1e-6, rel=1e-4)
