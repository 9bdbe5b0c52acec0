# SPDX-License-Identifier: GPL-3.0-or-later
"""Sampling dimensions: numbers are evenly distributed, and no two decisions are correlated."""

import ast
import re
from itertools import combinations

import numpy as np
import pytest

from ism_addon.sampling.dimensions import Dimension, draw, fixed_increments, fixed_point, white_noise
from ism_addon.sampling.increments import continued_fraction, powers_of_root
from tests.tools import project

ADDON = project.ROOT / "ism_addon"
OTHERS = [path for path in sorted(ADDON.rglob("*.py")) if path.parent.name != "sampling"]
SHADERS = [path for path in sorted(ADDON.rglob("*")) if path.suffix in {".frag", ".vert", ".glsl"}]
#: All that the rest of the package may import for random numbers: they all come from a dimension.
PUBLIC = {"Dimension", "draw", "fixed_increments", "fixed_point", "fixed_points", "white_noise"}

#: (dimension, index, component) of each increment.
INCREMENTS = {
    (each, index, k): increment
    for each in Dimension
    for index, increments in each.value.items()
    for k, increment in enumerate(increments)
}
#: Small multiples of two increments differ by at least this much, so that two sequences diverge in a thousand numbers.
MIN_DIFFERENCE = 2e-4


def distance_to_integer(values: np.ndarray) -> np.ndarray:
    """Distance of each number to the nearest integer."""
    return np.abs((values + 0.5) % 1.0 - 0.5)


def test_no_increment_is_a_simple_combination_of_another():
    """Otherwise two decisions would be correlated where one index is equal to the other or a small multiple of it."""
    multiples = np.array([(a, b) for a in (1, 2, 3) for b in (-3, -2, -1, 1, 2, 3)])
    for (one, x), (other, y) in combinations(INCREMENTS.items(), 2):
        assert distance_to_integer(multiples @ (x, y)).min() > MIN_DIFFERENCE, (one, other)


@pytest.mark.parametrize("first", [0, 3000])
def test_no_two_decisions_are_correlated(first):
    """For any two decisions of one index, pairs of their numbers fill the unit square evenly."""
    members = np.arange(first + 1, first + 1025)
    for (one, x), (other, y) in combinations(INCREMENTS.items(), 2):
        if one[1] == other[1]:
            counts, _, _ = np.histogram2d(members * x % 1.0, members * y % 1.0, 8, ((0.0, 1.0), (0.0, 1.0)))
            assert counts.min() >= 4 and counts.max() <= 32, (one, other)  # 16 on average


def test_no_sequence_returns_close_to_its_start():
    """Within thousands of members: if evenly distributed, the N-th is no closer to the start than about 1 / N."""
    members = np.arange(1, 4097)
    for decision, increment in INCREMENTS.items():
        assert (members * distance_to_integer(members * increment)).min() > 1e-3, decision


def test_a_decision_has_equally_many_increments_for_each_index():
    assert len(Dimension) == len(Dimension.__members__), "members with equal increments are aliases of one"
    for each in Dimension:
        assert len({len(increments) for increments in each.value.values()}) == 1, each


def test_every_decision_is_made_in_one_module():
    """Numbers of two modules that used the same dimension would be correlated."""
    texts = [path.read_text("utf-8") for path in ADDON.rglob("*.py")]
    for each in Dimension:
        assert sum(bool(re.search(rf"Dimension\.{each.name}\b", text)) for text in texts) == 1, each


@pytest.mark.parametrize("path", OTHERS, ids=lambda path: path.relative_to(ADDON).as_posix())
def test_every_random_number_has_a_dimension(path):
    """Nothing outside `sampling` makes a sequence or uses another source of random numbers."""
    text = path.read_text("utf-8")
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom):
            module, names = node.module or "", {alias.name for alias in node.names}
            assert not module.endswith("sampling.increments") and "increments" not in names
            assert not module.endswith("sampling.dimensions") or names <= PUBLIC
            assert module != "random"
        elif isinstance(node, ast.Import):
            assert "random" not in {alias.name for alias in node.names}
        elif isinstance(node, ast.Attribute):
            assert ast.unparse(node) not in ("np.random", "numpy.random")
    assert not re.search(r"Dimension\.\w+\.value", text)


@pytest.mark.parametrize("path", SHADERS, ids=lambda path: path.name)
def test_no_shader_has_increments_of_its_own(path):
    """Shaders get them as uniforms."""
    assert not re.search(r"fract\([^;]*\d*\.\d{3,}", path.read_text("utf-8"))


def test_numbers_of_several_indices_are_those_of_their_sum():
    """Python draws the number for some indices; a shader adds the increments of the others in fixed point."""
    light, probing = np.arange(5)[:, None], np.arange(3)
    numbers = draw(Dimension.CULLING_POINT, light=light, probing=probing)
    assert numbers.shape == (5, 3, 2)
    assert (numbers >= 0.0).all() and (numbers < 1.0).all()
    start = fixed_point(draw(Dimension.CULLING_POINT, light=3, probing=0))
    added = np.array(start) + 2 * np.array(fixed_increments(Dimension.CULLING_POINT, "probing"))
    assert added % 2**32 / 2**32 == pytest.approx(numbers[3, 2], abs=1e-8)


def test_an_index_that_a_decision_lacks_is_an_error():
    with pytest.raises(KeyError):
        draw(Dimension.PIXEL, light=0)
    with pytest.raises(KeyError):
        fixed_increments(Dimension.PIXEL, "light")


def test_white_noise_of_two_decisions_is_uncorrelated():
    one, other = (white_noise(each, (64, 64, 2)) for each in (Dimension.OCCLUSION, Dimension.PIXEL))
    assert np.array_equal(one, white_noise(Dimension.OCCLUSION, (64, 64, 2)))
    assert abs(np.corrcoef(one.ravel(), other.ravel())[0, 1]) < 0.05
    assert one.min() >= 0.0 and one.max() < 1.0 and one.mean() == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("first", [0, 17, 100_000])
def test_every_part_of_a_sequence_is_evenly_distributed(first):
    values = draw(Dimension.PIXEL, sample=np.arange(first, first + 64))
    for column in np.sort(values, axis=0).T:
        assert np.diff(column, append=column[0] + 1.0).max() < 4.0 / 64  # gaps of random numbers are up to 5


@pytest.mark.parametrize("coefficients", [(1, -1), (1, 0, -1), (-1, 2, 0, 1)])
def test_powers_of_a_root_satisfy_the_polynomial(coefficients):
    first, *_ = powers = powers_of_root(*coefficients)
    assert len(powers) == len(coefficients) - 1
    assert 0.0 < first < 1.0
    assert powers == pytest.approx([first**k for k in range(1, len(coefficients))])
    assert first ** len(coefficients) == pytest.approx(sum(c * first**k for k, c in enumerate(coefficients)))


def test_continued_fractions_repeat_their_quotients():
    assert continued_fraction(1) == pytest.approx([(5.0**0.5 - 1.0) / 2.0])
    (value,) = continued_fraction(1, 3)
    assert 1.0 / value == pytest.approx(1.0 + 1.0 / (3.0 + value))
