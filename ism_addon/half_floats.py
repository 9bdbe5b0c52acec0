# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversion of arrays to 16-bit floats and back, by integer operations.

numpy converts value by value, in two to four times the time; subnormal values, of dark images, in twelve times.

A 32-bit float that is multiplied by 2^-112 has the exponent of the 16-bit float in its lowest five bits of exponent,
also where that is subnormal; the mantissa has 13 more bits.
"""

from collections.abc import Iterator

import numpy as np

#: The largest 16-bit float.
MAX_HALF = 65504.0

SCALE = np.float32(2.0**-112)
#: Bits by which the mantissa is longer, and half of the last bit that is kept.
MORE_BITS = 13
HALF_BIT = np.uint32(1 << MORE_BITS - 1)
#: Of 16 and of 32 bits.
SIGN, SIGN_OF_FLOAT = np.uint16(1 << 15), np.uint32(1 << 31)

#: Values that are converted at a time: threads seldom wait for one another between such steps.
VALUES_AT_A_TIME = 1 << 19


def halves(values: np.ndarray, result: np.ndarray | None = None) -> np.ndarray:
    """float16 nearest to float32 values, of at most MAX_HALF in absolute value; of two as near, the larger.

    `result`: a contiguous float16 array that is filled, instead of a new one.
    """
    result = np.empty(values.shape, np.float16) if result is None else result
    for some, out in portions(values, result.view(np.uint16)):
        bits = (some * SCALE).view(np.uint32)
        bits += HALF_BIT
        np.right_shift(bits, MORE_BITS, out=out, casting="unsafe")
        if bits.max() >= SIGN_OF_FLOAT:
            out |= (bits >> np.uint32(16)).astype(np.uint16) & SIGN
    return result


def floats(values: np.ndarray) -> np.ndarray:
    """float32 of finite float16 values."""
    result = np.empty(values.shape, np.float32)
    for some, out in portions(values.view(np.int16), result.view(np.int32)):
        np.left_shift(some, MORE_BITS, out=out, dtype=np.int32)
        if some.min() < 0:
            out &= np.int32(-0x70000001)  # of the sign, which the shift has repeated, only the highest bit
        out.view(np.float32)[:] *= np.float32(1.0) / SCALE
    return result


def portions(values: np.ndarray, result: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Portions of both arrays, one-dimensional."""
    values, result = values.reshape(-1), result.reshape(-1)
    for first in range(0, len(values), VALUES_AT_A_TIME):
        portion = slice(first, first + VALUES_AT_A_TIME)
        yield values[portion], result[portion]
