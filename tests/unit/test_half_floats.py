# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of the conversion of arrays to 16-bit floats and back."""

import numpy as np
import pytest

from ism_addon import half_floats
from ism_addon.half_floats import MAX_HALF, floats, halves

ALL = np.arange(1 << 16, dtype=np.uint16).view(np.float16)
ALL = ALL[np.isfinite(ALL)]


def test_every_16_bit_float_stays_the_same():
    assert np.array_equal(floats(ALL).view(np.uint32), ALL.astype(np.float32).view(np.uint32))
    assert np.array_equal(halves(ALL.astype(np.float32)).view(np.uint16), ALL.view(np.uint16))


@pytest.mark.parametrize("sign", [(1.0,), (-1.0,), (1.0, -1.0)])
def test_the_nearest_is_taken(sign):
    random = np.random.default_rng(1)
    values = (10.0 ** random.uniform(-9.0, np.log10(MAX_HALF), (300, 1001)) * random.choice(sign)).astype(np.float32)
    error, least = (np.abs(each - values.astype(np.float64)) for each in (halves(values), values.astype(np.float16)))
    assert halves(values).shape == values.shape
    assert np.allclose(error, least, rtol=1e-3, atol=0.0)


def test_portions_are_the_same_as_all_at_once(monkeypatch):
    values = np.random.default_rng(2).standard_normal((7, 13, 4)).astype(np.float32)[:, ::2]
    expected = halves(values)
    monkeypatch.setattr(half_floats, "VALUES_AT_A_TIME", 10)
    assert np.array_equal(halves(values), expected)
    assert np.array_equal(floats(expected), expected.astype(np.float32))
    assert halves(values[:0]).shape == (0, 7, 4)


def test_an_array_is_filled():
    values, result = np.linspace(-2.0, 2.0, 77, dtype=np.float32).reshape(7, 11), np.empty((7, 11), np.float16)
    assert halves(values, result) is result
    assert np.array_equal(result, halves(values))
