# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers are evenly spread, and no decision follows another."""

from itertools import combinations

import numpy as np
import pytest

from ism_addon.sampling.dimensions import Dimension, rd_sequence, sequence
from tests.tools import project


@pytest.mark.parametrize("first", [0, 3000])
def test_no_two_decisions_follow_each_other(first):
    """Of each two, all pairs of numbers come up, evenly: neither is the other's, its double or what is left of it."""
    assert len(Dimension) == len(Dimension.__members__), "of equal increments Python makes one member"
    numbers = {
        f"{each.name} {k}": column for each in Dimension for k, column in enumerate(sequence(each, first, 1024).T)
    }
    for (one, x), (other, y) in combinations(numbers.items(), 2):
        counts, _, _ = np.histogram2d(x, y, 8, ((0.0, 1.0), (0.0, 1.0)))
        assert counts.min() >= 4 and counts.max() <= 32, (one, other)  # 16 on average


def test_every_decision_has_one_place():
    """Two that took the same dimension would follow each other."""
    texts = [path.read_text("utf-8") for path in (project.ROOT / "ism_addon").rglob("*.py")]
    for dimension in Dimension:
        assert sum(text.count(f"Dimension.{dimension.name}") for text in texts) == 1, dimension


def test_every_run_of_the_sequence_is_evenly_spread():
    for first in (0, 17, 100_000):
        values = rd_sequence(first, 64, 2)
        for column in np.sort(values, axis=0).T:
            assert np.diff(column, append=column[0] + 1.0).max() < 4.0 / 64  # random ones leave gaps of 5
