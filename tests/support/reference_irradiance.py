# SPDX-License-Identifier: GPL-3.0-or-later
"""Irradiance by one unoccluded light of radiance 1, in float64: slow, and accurate from contact to far away.

Without a spread, it is Lambert's edge sum (1760), over many edges for an ellipse. With a spread, it is an integral in
polar coordinates about the projection of the receiver onto the light's plane (`foot`): by the midpoint rule in angle,
by Gauss-Legendre quadrature along the radius.
"""

import numpy as np

from ism_addon.scene import Lights, LightShape
from ism_addon.spaces import orthonormal
from tests.support.emission import spread_factor

#: Edges that approximate an ellipse: the error of the rim is 4e-7 of its radius.
EDGES = 2048


def outline(lights: Lights) -> np.ndarray:
    """(K,3) corners of the only light, relative to its position. The polygon for an ellipse has the ellipse's area."""
    corners = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    if lights.shape[0] == LightShape.ELLIPSE:
        angle = 2.0 * np.pi * np.arange(EDGES) / EDGES
        radius = 0.5 * np.sqrt(2.0 * np.pi / (EDGES * np.sin(2.0 * np.pi / EDGES)))
        corners = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    return corners @ np.stack([lights.axis_u[0], lights.axis_v[0]])


def edge_sum(polygon: np.ndarray, normal: np.ndarray) -> float:
    """Irradiance at the origin by the part of a convex polygon (K,3) that is above the horizon of a normal."""
    heights = polygon @ normal
    ends, end_heights = np.roll(polygon, -1, 0), np.roll(heights, -1)
    is_above, is_all_above = (heights > 0.0) | (end_heights > 0.0), (heights > 0.0) & (end_heights > 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossings = polygon + np.where(is_all_above, 0.0, heights / (heights - end_heights))[:, None] * (ends - polygon)
    first = np.where(heights[:, None] > 0.0, polygon, crossings)[is_above]
    last = np.where(end_heights[:, None] > 0.0, ends, crossings)[is_above]
    if is_above.any() and not is_all_above.all():  # along the horizon
        leaves, enters = crossings[is_above & (end_heights <= 0.0)], crossings[is_above & (heights <= 0.0)]
        first, last = np.concatenate([first, leaves]), np.concatenate([last, enters])
    across = np.cross(first, last - first)
    sine = np.linalg.norm(across, axis=1)
    angle = np.arctan2(sine, (first * last).sum(1))
    return float(0.5 * abs(((across @ normal) * angle / np.maximum(sine, 1e-300)).sum()))


def chords(foot: np.ndarray, directions: np.ndarray, ellipse: bool) -> np.ndarray:
    """(2,…) distances at which lines from `foot` (2,) along directions (…,2) enter and leave the light.

    In units of the light's axes: of a unit square, or of the disk of diameter 1. Both are 0 for a line that misses.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        if ellipse:
            square, along = (directions**2).sum(-1), directions @ foot
            root = np.sqrt(np.maximum(along**2 - square * (foot @ foot - 0.25), 0.0))
            ends = np.stack([-along - root, -along + root]) / square
        else:
            sides = np.sort(np.stack([-0.5 - foot, 0.5 - foot])[:, None] / directions, 0)
            ends = np.stack([sides[0].max(-1), sides[1].min(-1)])
    ends = np.maximum(ends, 0.0)
    return np.where(ends[1] > ends[0], ends, 0.0)


def spread_integral(point: np.ndarray, normal: np.ndarray, lights: Lights, angles: int = 2000) -> float:
    """W/m² at one receiver (3,), (3,): the light's spread weights the directions of emission."""
    plane = np.cross(lights.axis_u[0], lights.axis_v[0])
    plane *= np.sign(plane @ lights.normal[0]) / np.linalg.norm(plane)
    height = (point - lights.position[0]) @ plane
    if height <= 0.0:
        return 0.0
    x, y = orthonormal(plane)
    axes = np.stack([lights.axis_u[0], lights.axis_v[0]])
    world_from_plane = np.stack([x, y])
    light_from_plane = world_from_plane @ np.linalg.pinv(axes)
    foot = (point - height * plane - lights.position[0]) @ np.linalg.pinv(axes)
    ellipse = lights.shape[0] == LightShape.ELLIPSE

    rim = (outline(lights) - point + lights.position[0]) @ world_from_plane.T
    centre = world_from_plane @ (lights.position[0] - point)
    azimuth = np.arctan2(centre[0] * rim[:, 1] - centre[1] * rim[:, 0], rim @ centre)
    inside = np.ptp(chords(foot, np.array([[1.0, 0.0], [-1.0, 0.0]]), ellipse), 0).all()
    first, last = (
        (0.0, 2.0 * np.pi) if inside else np.arctan2(centre[1], centre[0]) + np.array([azimuth.min(), azimuth.max()])
    )
    phase = (np.arange(angles) + 0.5) / angles * np.pi  # denser where an ellipse's chords vanish
    angle = first + (last - first) * (phase / np.pi if inside else 0.5 - 0.5 * np.cos(phase))
    step = (last - first) / angles * (1.0 if inside else 0.5 * np.pi * np.sin(phase))
    direction = np.column_stack([np.cos(angle), np.sin(angle)])
    ends = chords(foot, direction @ light_from_plane, ellipse) / height
    slope, level = direction @ (world_from_plane @ normal), -(normal @ plane)
    with np.errstate(divide="ignore", invalid="ignore"):
        horizon = -level / slope  # n·p = level + r slope, in units of the height
    spread_tangent = np.tan(lights.spread[0] / 2.0)
    low = np.where((slope > 0.0) & (level < 0.0), np.maximum(ends[0], horizon), ends[0])
    high = np.where(slope < 0.0, np.minimum(ends[1], np.maximum(horizon, 0.0)), ends[1])
    high = np.minimum(np.where((slope <= 0.0) & (level <= 0.0), 0.0, high), spread_tangent)
    low = np.minimum(low, high)
    node, weight = np.polynomial.legendre.leggauss(48)
    tilt = np.arctan(low) + (np.arctan(high) - np.arctan(low)) * (0.5 + 0.5 * node[:, None])
    r = np.tan(tilt)
    radial_weight = (np.arctan(high) - np.arctan(low)) * 0.5 * weight[:, None] * (1.0 + r**2) * r / (1.0 + r**2) ** 2
    factor = spread_factor(float(lights.spread[0]), np.cos(tilt))
    return float((radial_weight * (level + slope * r) * factor * step).sum())


def cap_integral(cosine: float, sine: float, angles: int = 4000) -> float:
    """Irradiance of a spherical cap of radiance 1, as a sum over the angle to its centre.

    `cosine`: of the angle between the receiver's normal and the centre; `sine`: of half of the cap's angle.
    """
    step = np.arcsin(sine) / angles
    angle = (np.arange(angles) + 0.5) * step
    mean, amplitude = cosine * np.cos(angle), np.sqrt(1.0 - cosine * cosine) * np.sin(angle)
    with np.errstate(divide="ignore", invalid="ignore"):
        end = np.arccos(np.clip(-mean / amplitude, -1.0, 1.0))  # of the azimuths above the horizon
    end = np.where(amplitude == 0.0, np.where(mean > 0.0, np.pi, 0.0), end)
    return float(2.0 * ((mean * end + amplitude * np.sin(end)) * np.sin(angle)).sum() * step)


def point_irradiance(point: np.ndarray, normal: np.ndarray, lights: Lights) -> float:
    """W/m² at one receiver (3,), (3,), by a point light of intensity 1 W/sr."""
    to_light, radius = lights.position[0] - point, lights.radius[0]
    square = to_light @ to_light
    cosine = to_light @ normal / np.sqrt(square)
    if radius == 0.0:
        return max(cosine, 0.0) / square
    if lights.soft_falloff[0]:
        square += radius * radius
    if square <= radius * radius:
        return 1.0 / radius**2
    return cap_integral(cosine, radius / np.sqrt(square)) / (np.pi * radius**2)


def irradiance(point: np.ndarray, normal: np.ndarray, lights: Lights) -> float:
    """W/m² at one receiver (3,), (3,), without the light's spread."""
    plane = np.cross(lights.axis_u[0], lights.axis_v[0])
    if (point - lights.position[0]) @ (plane * np.sign(plane @ lights.normal[0])) <= 0.0:
        return 0.0
    return edge_sum(lights.position[0] - point + outline(lights), normal)
