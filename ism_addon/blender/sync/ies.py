# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads IES files (ANSI/IES LM-63) as Cycles 5.0 does: its units, its interpolation, its completion of symmetric files.

Before, Cycles did not interpolate across azimuth 0: files of few azimuths were up to an eighth brighter on one side.
"""

from collections.abc import Iterator
from functools import lru_cache
from itertools import islice

import numpy as np

from ...scene.light_profiles import AZIMUTHS, POLAR_ANGLES, LightProfile
from ...scene.limits import MAX_DISTANCE

#: From candela to Cycles' factor of a light's power: 4 pi, over the luminous efficacy of D65 in lm/W.
FACTOR_OF_CANDELA = 4.0 * np.pi / 177.83

#: What Cycles takes for a file that it cannot read.
UNREADABLE = 100.0

#: More than any file has: 10 characters for each direction, 0.5 degrees apart.
MAX_CHARACTERS = 10 * 720 * 360

#: Largest number of angles along an axis: 0.1 degrees apart.
MAX_ANGLES = 3601


class Unreadable(Exception):
    """The file is none that Cycles reads."""


@lru_cache(maxsize=64)
def read(text: str) -> tuple[LightProfile, float] | None:
    """The profile of a file with this text, and the largest factor of the light's power. None if it is not readable."""
    try:
        azimuths, polar_angles, candela = measured(text)
    except (Unreadable, ValueError, IndexError, OverflowError):  # it ends early, or has a word where a number belongs
        return None
    if not np.abs(candela).max() <= MAX_DISTANCE:  # also if one is no number
        return None
    rows = np.linspace(0.0, 360.0, AZIMUTHS)
    columns = np.linspace(0.0, 180.0, POLAR_ANGLES)
    along = interpolated(azimuths, candela, rows, wraps=azimuths[-1] == 360.0)
    factors = FACTOR_OF_CANDELA * np.maximum(interpolated(polar_angles, along.T, columns).T, 0.0)
    factors[rows > azimuths[-1]] = 0.0
    factors[:, (columns < polar_angles[0]) | (columns > polar_angles[-1])] = 0.0
    peak = float(factors.max())
    return LightProfile((factors / peak if peak > 0.0 else factors).astype(np.float32)), peak


def measured(text: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Azimuths (H,) and polar angles (V,), degrees, and candela (H,V). Raises what `read` catches."""
    tilt = text.index("\nTILT=")
    rest = text[tilt + 1 :].replace(",", " ").split("\n", 1)[1]
    numbers = iter(rest.split())
    if text.startswith("\nTILT=INCLUDE", tilt):
        _geometry, count = next_numbers(numbers, 2)
        next_numbers(numbers, 2 * int(count))
    _lamps, _lumens, multiplier, polar_count, azimuth_count, photometric_type, _unit, *_size = next_numbers(numbers, 10)
    ballast, ballast_lamp, _watts = next_numbers(numbers, 3)
    if not (0 < polar_count <= MAX_ANGLES and 0 < azimuth_count <= MAX_ANGLES):
        raise Unreadable
    polar_angles, azimuths = (next_numbers(numbers, int(count)) for count in (polar_count, azimuth_count))
    candela = next_numbers(numbers, len(polar_angles) * len(azimuths)).reshape(len(azimuths), len(polar_angles))
    candela = candela * (multiplier * ballast * ballast_lamp)
    if photometric_type == 2.0:
        azimuths, polar_angles, candela = from_type_b(polar_angles, azimuths, candela.T)
    elif photometric_type == 1.0:
        azimuths, candela = full_circle(azimuths, candela)
    else:
        raise Unreadable
    if len(polar_angles) < 2 or not all((np.diff(angles) > 0.0).all() for angles in (azimuths, polar_angles)):
        raise Unreadable
    if polar_angles[0] not in (0.0, 90.0) or (polar_angles[0] == 90.0 and polar_angles[-1] != 180.0):
        raise Unreadable
    return azimuths, polar_angles, candela


def next_numbers(numbers: Iterator[str], count: int) -> np.ndarray:
    """(count,) float64. Raises Unreadable if there are fewer, and ValueError."""
    result = np.array([float(word) for word in islice(numbers, count)])
    if len(result) < count:
        raise Unreadable
    return result


def full_circle(azimuths: np.ndarray, candela: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Type C: azimuths from 0 to 360 degrees, of files of one azimuth, a quadrant, a half, or without the last one."""
    if azimuths[0] == 90.0:
        azimuths = azimuths - 90.0
    if azimuths[0] != 0.0:
        raise Unreadable
    if len(azimuths) == 1:
        return np.array([0.0, 360.0]), candela[[0, 0]]
    for end in (90.0, 180.0):
        if azimuths[-1] == end:
            azimuths = np.concatenate([azimuths, 2.0 * end - azimuths[-2::-1]])
            candela = np.concatenate([candela, candela[-2::-1]])
    gap = 360.0 - azimuths[-1]
    if gap != 0.0:
        if gap not in (azimuths[-1] - azimuths[-2], azimuths[1] - azimuths[0]):
            raise Unreadable
        azimuths, candela = np.append(azimuths, 360.0), np.concatenate([candela, candela[:1]])
    return azimuths, candela


def from_type_b(
    azimuths: np.ndarray, polar_angles: np.ndarray, candela: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Type B: its vertical angles are azimuths up to 180 degrees, its horizontal ones polar angles; candela (H,V)."""
    azimuths, candela = half_circle(azimuths, candela)
    polar_angles, columns = half_circle(polar_angles, candela.T)
    return azimuths, polar_angles, columns.T


def half_circle(angles: np.ndarray, candela: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles from 0 to 180 degrees, from those of -90 to 90 degrees or of the half from 0 on; `candela` by rows."""
    if angles[-1] != 90.0 or angles[0] not in (0.0, -90.0):
        raise Unreadable
    if angles[0] == 0.0:
        angles, candela = np.concatenate([-angles[:0:-1], angles]), np.concatenate([candela[:0:-1], candela])
    return angles + 90.0, candela


def interpolated(angles: np.ndarray, values: np.ndarray, at: np.ndarray, wraps: bool = False) -> np.ndarray:
    """Values (N,…) of rows `values` (A,…) by cubic interpolation (Catmull-Rom), as if angles were evenly spaced.

    Before 0 and after 180 degrees, values are those of the other side, unless the last angle `wraps` to the first.
    """
    last = len(angles) - 1
    index = np.clip(np.searchsorted(angles, at, side="left") - 1, 0, last - 1)
    fraction = np.clip((at - angles[index]) / (angles[index + 1] - angles[index]), 0.0, 1.0)
    fraction = fraction.reshape(-1, *[1] * (values.ndim - 1))
    before = np.where(index > 0, index - 1, last - 1 if wraps else min(last, 1) if angles[0] == 0.0 else 0)
    after = np.where(index + 2 <= last, index + 2, 1 if wraps else last - 1 if angles[-1] == 180.0 else last)
    a, b, c, d = (values[rows] for rows in (before, index, index + 1, after))
    square = fraction * fraction
    slope, bend = 0.5 * (c - a), a - 2.5 * b + 2.0 * c - 0.5 * d
    result: np.ndarray = b + slope * fraction + bend * square + (1.5 * (b - c) + 0.5 * (d - a)) * square * fraction
    return result
