# SPDX-License-Identifier: GPL-3.0-or-later
"""Increments of additive sequences: irrational numbers whose multiples are never close to integers.

A number of degree d + 1 and its first d powers are such increments in d dimensions (Perron 1921). The sequences R_d
(Roberts 2018) are those of x^(d+1) = 1 - x^d.
"""


def powers_of_root(*coefficients: int) -> tuple[float, ...]:
    """Powers 1 … d, in [0,1), of the root in (0,1) of x^(d+1) = c₀ + c₁ x + … + c_d x^d."""

    def is_below(x: float) -> bool:
        return x ** len(coefficients) < sum(c * x**k for k, c in enumerate(coefficients))

    low, high = 0.0, 1.0
    for _ in range(64):
        middle = 0.5 * (low + high)
        if is_below(middle) == is_below(0.0):
            low = middle
        else:
            high = middle
    return tuple(low**k for k in range(1, len(coefficients)))


def continued_fraction(*quotients: int) -> tuple[float]:
    """The number in (0,1) whose continued fraction repeats `quotients`. Smaller ones make its sequence more even."""
    value = 0.0
    for _ in range(64):
        for quotient in reversed(quotients):
            value = 1.0 / (quotient + value)
    return (value,)
