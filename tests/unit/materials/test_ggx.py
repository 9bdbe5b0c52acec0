# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference of GGX that the tables are made from: samples have their density, and albedos their limits."""

import numpy as np
import pytest

from tests.tables import albedo, ggx


@pytest.mark.parametrize(("alpha", "cosine"), [(0.05, 0.9), (0.3, 0.3), (1.0, 0.6)])
def test_reflections_have_their_density(alpha, cosine):
    """By uniform directions: the density's integral, and its means of the coordinates, are those of the samples."""
    u, v = (each.ravel() for each in np.meshgrid(*2 * [(np.arange(400) + 0.5) / 400]))
    wi = ggx.direction(np.array(cosine))
    wo = ggx.reflect(wi, ggx.sample_visible_normal(wi, np.array(alpha), u, v))
    mirror = ggx.direction(np.array(cosine)) * [-1.0, 1.0, 1.0]
    # Directions around the mirror direction, denser towards it.
    angle, phi = np.pi * v**3, 2.0 * np.pi * u
    weight = 2.0 * np.pi**2 * 3.0 * v**2 * np.sin(angle)
    x = np.array([mirror[2], 0.0, -mirror[0]])
    local = np.stack([np.sin(angle) * np.cos(phi), np.sin(angle) * np.sin(phi), np.cos(angle)], 1)
    directions = local @ np.stack([x, np.cross(mirror, x), mirror])
    h = wi + directions
    density = np.where(h[:, 2] > 0.0, ggx.density(wi, directions, np.array(alpha)), 0.0) * weight
    assert density.mean() == pytest.approx(1.0, abs=2e-3)
    assert (density[:, None] * directions).mean(0) == pytest.approx(wo.mean(0), abs=2e-3)
    assert (density[:, None] * directions**2).mean(0) == pytest.approx((wo**2).mean(0), abs=2e-3)


def test_the_model_is_reciprocal():
    random = np.random.default_rng(0)
    wi, wo = random.normal(size=(2, 50, 3))
    wi, wo = (np.abs(each) / np.linalg.norm(each, axis=1, keepdims=True) for each in (wi, wo))
    alpha = random.random(50)
    forward, backward = ggx.evaluate(wi, wo, alpha) / wo[:, 2], ggx.evaluate(wo, wi, alpha) / wi[:, 2]
    assert forward == pytest.approx(backward, rel=1e-9)


def test_mirrors_lose_no_light():
    assert albedo.directional_albedo(0.01, np.array([0.2, 1.0])) == pytest.approx(1.0, abs=1e-4)


def test_fresnel_has_its_known_values():
    """F0 and Brewster's angle of glass; Schlick's limits, and the tint at 82°."""
    assert ggx.fresnel_dielectric(np.array(1.0), 1.5) == pytest.approx(0.04)
    cosine, sine = np.cos(np.arctan(1.5)), np.sin(np.arctan(1.5))
    only_perpendicular = 0.5 * ((cosine - 1.5 * sine) / (cosine + 1.5 * sine)) ** 2
    assert ggx.fresnel_dielectric(cosine, 1.5) == pytest.approx(only_perpendicular)
    assert ggx.fresnel_dielectric(np.array(0.1), 0.6) == 1.0
    assert ggx.fresnel_f82(np.array([1.0, 0.0]), 0.3, 0.5) == pytest.approx([0.3, 1.0])
    assert ggx.fresnel_f82(1.0 / 7.0, 0.3, 0.5) == pytest.approx(0.5 * ggx.fresnel_f82(1.0 / 7.0, 0.3, 1.0))
