# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps of all directions: rows are latitudes and columns longitudes, as Blender's Environment Texture has them."""

import numpy as np


def coordinates(directions: np.ndarray) -> np.ndarray:
    """(…,2) in [0,1] of unit vectors (…,3): u falls with the longitude, v grows from -z to +z."""
    x, y, z = (directions[..., k] for k in range(3))
    u = 0.5 - np.arctan2(y, x) / (2.0 * np.pi)
    return np.stack([u, 1.0 - np.arccos(np.clip(z, -1.0, 1.0)) / np.pi], -1)


def directions_at(rows: np.ndarray, columns: np.ndarray, height: int, width: int) -> np.ndarray:
    """(R,C,3) unit vectors of the texels in rows (R,) and columns (C,) of a map."""
    polar = (np.pi * (1.0 - (rows + 0.5) / height))[:, None]
    azimuth = np.pi - 2.0 * np.pi * (columns + 0.5) / width
    sine, cosine = np.sin(polar), np.broadcast_to(np.cos(polar), (len(rows), len(columns)))
    return np.stack((sine * np.cos(azimuth), sine * np.sin(azimuth), cosine), -1)


def texel_directions(height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Of the texels of a map, row by row, float32: unit vectors (P,3), and solid angles (P,1) sr."""
    rows = np.arange(height)
    sine = np.sin(np.pi * (rows + 0.5) / height)[:, None]
    solid_angles = np.broadcast_to(sine * (np.pi / height) * (2.0 * np.pi / width), (height, width))
    directions = directions_at(rows, np.arange(width), height, width)
    return directions.reshape(-1, 3).astype(np.float32), solid_angles.reshape(-1, 1).astype(np.float32)


def interpolated(values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """(N,) bilinear values of a map (H,W) at coordinates (N,2); columns repeat."""
    height, width = values.shape
    texel = at * (width, height) - 0.5
    corner = np.floor(texel).astype(np.int64)
    u, v = (texel - corner).astype(values.dtype).T
    left, right = corner[:, 0] % width, (corner[:, 0] + 1) % width
    below, above = np.clip(corner[:, 1], 0, height - 1), np.clip(corner[:, 1] + 1, 0, height - 1)
    low = (1.0 - u) * values[below, left] + u * values[below, right]
    result: np.ndarray = (1.0 - v) * low + v * ((1.0 - u) * values[above, left] + u * values[above, right])
    return result


def reduced(radiance: np.ndarray, width: int) -> np.ndarray:
    """The map (H,W,3) with means of squares of texels, weighted by solid angle, down to about `width` columns."""
    factor = max(radiance.shape[1] // width, 1)
    height, columns = (size // factor for size in radiance.shape[:2])
    if factor == 1 or height == 0:
        return radiance
    latitude = (np.arange(height * factor) + 0.5) / (height * factor) * np.pi
    weight = np.sin(latitude).reshape(height, factor)
    weight = (weight / (factor * weight.sum(1, keepdims=True))).astype(radiance.dtype)
    result = np.zeros((height, columns, 3), radiance.dtype)
    for channel in range(3):  # numpy adds one of all texels at once, but three channels texel by texel
        texels = radiance[: height * factor, : columns * factor, channel]
        rows = sum(texels[k::factor] * weight[:, k, None] for k in range(factor))
        for k in range(factor):
            result[..., channel] += rows[:, k::factor]
    return result
