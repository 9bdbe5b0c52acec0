# SPDX-License-Identifier: GPL-3.0-or-later
"""Work on several cores: its results are in order, few wait, and its errors are raised."""

import threading

import pytest

from ism_addon.parallel import MAX_WAITING, MIN_PARALLEL_SIZE, parallel_map, parallel_results


@pytest.mark.parametrize("size", [1, MIN_PARALLEL_SIZE + 1])
@pytest.mark.parametrize("function", [parallel_map, parallel_results])
def test_results_are_in_order(function, size):
    assert list(function(lambda number: number * number, range(50), size)) == [k * k for k in range(50)]
    assert list(function(abs, [], size)) == []


def test_few_results_wait_for_being_used():
    started, lock = [], threading.Lock()

    def work(number):
        with lock:
            started.append(number)
        return number

    for index, result in enumerate(parallel_results(work, range(100), MIN_PARALLEL_SIZE + 1)):
        assert result == index and len(started) <= index + MAX_WAITING


@pytest.mark.parametrize("size", [1, MIN_PARALLEL_SIZE + 1])
def test_an_error_is_raised_where_its_result_would_be(size):
    results = parallel_results(lambda number: 1 // (3 - number), range(10), size)
    assert [next(results) for _ in range(3)] == [0, 0, 1]
    with pytest.raises(ZeroDivisionError):
        next(results)
