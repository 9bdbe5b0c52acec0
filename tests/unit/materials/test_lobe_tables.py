# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of glossy lobes against integrals of the lobes between the tables' entries, and GLSL's look-ups in them."""

import numpy as np
import pytest

from ism_addon.gpu.materials import lobe_tables
from tests.tables import albedo, ggx, lookup, ltc
from tests.unit.shading import glsl_functions

COUNT = 400
FUNCTIONS = {
    "ltc_inverse": 2,
    "ggx_albedo": 2,
    "ggx_mean_albedo": 1,
    "dielectric_s": 3,
    "schlick_s": 2,
    "glass_albedo": 3,
    "glass_mean_albedo": 2,
    "sheen_ltc": 2,
}


def random_operands() -> list[np.ndarray]:
    """(N,) roughness, cosine and index of refraction; a part of them at the ends of the tables."""
    random = np.random.default_rng(1)
    unit = random.random((2, COUNT))
    unit = np.where(random.random(unit.shape) < 0.1, random.choice([0.0, 1.0], unit.shape), unit)
    operands = [*unit, random.choice([0.8, 1.0, 1.3, 1.5, 2.5, 30.0], COUNT)]
    return [each.astype(np.float32).astype(np.float64) for each in operands]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_shader_looks_up_what_the_tables_hold(device, name):
    operands = random_operands()[: FUNCTIONS[name]]
    expected = getattr(lookup, name)(*operands).reshape(COUNT, -1)
    call = f"{name}({', '.join(f'a{k}' for k in range(len(operands)))})"
    rows = device.buffer_from(lobe_tables.texture_rows())
    result = glsl_functions.evaluate(device, "materials/lobe_tables.glsl", call, operands, lobe_tables=rows)
    assert np.abs(result[:, : expected.shape[1]] - expected).max() < 4e-6


def between_entries(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Roughness and cosines at random, no grazing ones."""
    random = np.random.default_rng(seed)
    return random.uniform(0.05, 1.0, count), random.uniform(0.15, 1.0, count)


def test_albedos_are_those_of_the_lobe():
    roughness, cosine = between_entries(60, 2)
    exact = np.array([albedo.directional_albedo(r, np.array([c]))[0] for r, c in zip(roughness, cosine, strict=True)])
    assert np.abs(lookup.ggx_albedo(roughness, cosine) - exact).max() < 0.0035
    means = np.array([albedo.mean_albedo(r) for r in roughness[:10]])
    assert np.abs(lookup.ggx_mean_albedo(roughness[:10]) - means).max() < 0.001


def test_dielectric_albedos_are_those_of_the_lobe():
    """The table is coarse, as Cycles' is."""
    roughness, cosine = between_entries(60, 3)
    eta = np.random.default_rng(4).uniform(1.2, 2.5, len(roughness))
    exact = [
        albedo.mean_shape(r, np.array([c]), lambda cos_h, e=e: ggx.dielectric_shape(cos_h, e))[0]
        for r, c, e in zip(roughness, cosine, eta, strict=True)
    ]
    assert np.abs(lookup.dielectric_s(roughness, cosine, eta) - exact).max() < 0.007
    schlick = [
        albedo.mean_shape(r, np.array([c]), lambda cos_h: (1.0 - cos_h) ** 5)[0]
        for r, c in zip(roughness, cosine, strict=True)
    ]
    assert np.abs(lookup.schlick_s(roughness, cosine) - schlick).max() < 0.009


def test_the_generator_makes_the_tables():
    tables = lobe_tables.tables()
    row = albedo.directional_albedo(albedo.grid(albedo.ROUGHNESS_COUNT)[20], albedo.grid(albedo.COSINE_COUNT))
    assert np.abs(tables["albedo"][20] - row).max() < 1e-6
    row = albedo.glass_albedo(albedo.grid(albedo.SHAPE_COUNT)[10], albedo.grid(albedo.SHAPE_COUNT), 1.5)
    assert (
        np.abs(lookup.glass_albedo(np.full(16, 10.0 / 15.0), np.linspace(0.0, 1.0, 16), np.full(16, 1.5)) - row).max()
        < 0.01
    )
    assert tables["ltc"].shape == (ltc.COUNT, ltc.COUNT, 4)


def test_the_file_is_small():
    assert lobe_tables.FILE.stat().st_size < 100_000
