# SPDX-License-Identifier: GPL-3.0-or-later
"""The disc of a sky's sun: when it is shown, its limb darkening, and its irradiance."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.shading.sky import Sky, SkyModel, sun, sun_irradiance, sun_radiance
from ism_addon.shading.sky.parameters import ANALYTIC, direction_at

SCATTERING = [model for model in SkyModel if model not in ANALYTIC]
#: The mean of the limb darkening 1 - 0.6 (1 - √(1 - r²)) over a disc.
MEAN_OF_LIMB = 1.0 - 0.6 / 3.0


def sky_with_disc(model, **settings):
    return Sky(model, **{"sun_elevation": 0.5, "sun_rotation": 0.7, "sun_size": 0.02} | settings)


@pytest.mark.parametrize("model", SkyModel)
def test_only_scattering_has_a_disc_while_it_is_shown(model):
    sky = sky_with_disc(model)
    assert (sun(sky) is None) == (model in ANALYTIC)
    assert sun(replace(sky, sun_disc=False)) is None
    assert sun(replace(sky, sun_intensity=0.0)) is None
    assert sun(replace(sky, sun_elevation=-0.2)) is None


@pytest.mark.parametrize("model", SCATTERING)
def test_the_disc_is_where_the_node_has_the_sun(model):
    sky = sky_with_disc(model, sun_elevation=math.pi - 0.5)
    direction = direction_at(0.5, 0.7 + math.pi)
    assert np.allclose(sun(sky).direction, direction)
    inside = [direction_at(0.5 + up, 0.7 + math.pi + right) for up, right in ((0.0, 0.0), (0.009, 0.0), (0.0, 0.01))]
    outside = [direction_at(0.5 + up, 0.7 + math.pi + right) for up, right in ((0.011, 0.0), (0.0, 0.012), (0.0, 1.0))]
    assert sun_radiance(sun(sky), np.array(inside)).all(1).tolist() == [True] * 3
    assert not sun_radiance(sun(sky), np.array(outside)).any()


@pytest.mark.parametrize("model", SCATTERING)
def test_the_disc_is_redder_below_and_darker_at_its_limb(model):
    shown = sun(sky_with_disc(model, sun_elevation=0.05, sun_size=0.06))
    points = (-0.02, 0.0), (0.02, 0.0), (0.0, 0.0), (0.0, 0.029), (0.0, -0.029)
    below, above, centre, right, left = sun_radiance(
        shown, np.array([direction_at(0.05 + up, 0.7 + turn) for up, turn in points])
    )
    assert below[0] / below[1] > above[0] / above[1] and below[0] < above[0]
    assert np.allclose(left, right, rtol=1e-5) and (right < 0.65 * centre).all()


@pytest.mark.parametrize("model", SCATTERING)
@pytest.mark.parametrize("size", [0.0, 0.01, 0.2])
def test_the_irradiance_is_the_radiance_times_the_solid_angle(model, size):
    """At the zenith, where the radiance depends on the distance from the centre alone, but for half a percent."""
    shown = sun(sky_with_disc(model, sun_elevation=0.5 * math.pi, sun_size=size, sun_intensity=3.0))
    (centre,) = sun_radiance(shown, shown.direction[None])
    expected = MEAN_OF_LIMB * math.pi * (0.5 * shown.angular_diameter) ** 2 * centre
    assert np.allclose(sun_irradiance(shown), expected, rtol=0.01)


@pytest.mark.parametrize("model", SCATTERING)
def test_the_irradiance_does_not_depend_on_the_size(model):
    small, large = (sun_irradiance(sun(sky_with_disc(model, sun_size=size))) for size in (0.01, 0.1))
    assert np.allclose(small, large, rtol=0.02)


def test_the_ground_hides_half_of_a_sun_on_the_horizon():
    shown = sun(sky_with_disc(SkyModel.MULTIPLE_SCATTERING, sun_elevation=0.0, altitude=0.0))
    seen, hidden = sun_radiance(shown, np.array([direction_at(0.005, 0.7), direction_at(-0.005, 0.7)]))
    assert seen.any() and not hidden.any()
    higher = sun(sky_with_disc(SkyModel.MULTIPLE_SCATTERING, sun_elevation=0.0, altitude=1000.0))
    assert sun_radiance(higher, np.array([direction_at(-0.005, 0.7)])).any()


@pytest.mark.parametrize("model", SCATTERING)
@pytest.mark.parametrize("size", [0.0, 0.5 * math.pi])
@pytest.mark.parametrize("elevation", [0.0, 0.5 * math.pi])
@pytest.mark.parametrize(("altitude", "density"), [(0.0, 0.0), (100e3, 10.0), (0.0, 1000.0)])
def test_discs_are_finite_at_the_ends_of_settings(model, size, elevation, altitude, density):
    densities = dict.fromkeys(("air_density", "aerosol_density", "ozone_density"), density)
    settings = {"sun_size": size, "sun_elevation": elevation, "altitude": altitude, "sun_intensity": 1000.0}
    shown = sun(sky_with_disc(model, **settings, **densities))
    if shown is not None:
        assert np.isfinite(sun_irradiance(shown)).all() and np.isfinite(shown.radiances).all()
