# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights as grids of points, in float64."""

import numpy as np

from ism_addon.scene import Lights, LightShape
from ism_addon.spaces import orthonormal
from tests.support.emission import spot_attenuation, spread_factor

#: Distance of the points that stand for a sun, m.
SUN_DISTANCE = 1e5


def grid_on_light(lights: Lights, light: int, side: int) -> tuple[np.ndarray, float]:
    """(N,3) points, the centres of cells of equal area on the light; and the area of a cell.

    The area is in m², of points in π times the square of the radius: their emission is an intensity. Points of a sun
    lie SUN_DISTANCE away, and the area is a fraction of it.
    """
    if lights.shape[light] == LightShape.SUN:
        side = side if lights.spread[light] > 0.0 else 1
        middle = (np.arange(side) + 0.5) / side
        a, b = (grid.ravel() for grid in np.meshgrid(middle, middle, indexing="ij"))
        across = np.sin(lights.spread[light] / 2.0) * np.sqrt(a)
        at = [across * np.cos(2.0 * np.pi * b), across * np.sin(2.0 * np.pi * b), np.sqrt(1.0 - across**2)]
        axis = -lights.normal[light]
        return SUN_DISTANCE * np.column_stack(at) @ np.stack([*orthonormal(axis), axis]), 1.0 / side**2
    is_point = lights.shape[light] in (LightShape.POINT, LightShape.SPOT)
    if is_point and lights.radius[light] == 0.0:
        return lights.position[light][None], 1.0
    middle = (np.arange(side) + 0.5) / side
    a, b = (grid.ravel() for grid in np.meshgrid(middle, middle, indexing="ij"))
    if is_point:
        radius, angle = np.sqrt(1.0 - (2.0 * a - 1.0) ** 2), 2.0 * np.pi * b
        directions = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 2.0 * a - 1.0])
        return lights.position[light] + lights.radius[light] * directions, 4.0 / side**2
    area = np.linalg.norm(np.cross(lights.axis_u[light], lights.axis_v[light]))
    u, v = a - 0.5, b - 0.5
    if lights.shape[light] == LightShape.ELLIPSE:
        u, v = 0.5 * np.sqrt(a) * np.cos(2 * np.pi * b), 0.5 * np.sqrt(a) * np.sin(2 * np.pi * b)
        area *= np.pi / 4.0
    return lights.position[light] + np.outer(u, lights.axis_u[light]) + np.outer(
        v, lights.axis_v[light]
    ), area / side**2


def irradiance_per_area(
    points: np.ndarray, normals: np.ndarray, emitters: np.ndarray, lights: Lights, light: int
) -> np.ndarray:
    """Irradiance (…) at receivers (…,3) per area and radiance of points (…,3) on a light."""
    to_light = emitters - points
    square = (to_light**2).sum(-1)
    receiver = np.maximum((normals * to_light).sum(-1), 0.0)
    if lights.shape[light] == LightShape.SUN:
        return receiver / np.maximum(-to_light @ lights.normal[light], 1e-9)
    if lights.shape[light] in (LightShape.POINT, LightShape.SPOT):
        outwards = emitters - lights.position[light]
        radius = lights.radius[light]
        sender = np.sqrt(square) if radius == 0.0 else np.maximum(-(to_light * outwards).sum(-1) / radius, 0.0)
        is_spot = lights.shape[light] == LightShape.SPOT
        return receiver * sender / square**2 * (spot_attenuation(-to_light, lights, light) if is_spot else 1.0)
    sender = np.maximum(-to_light @ lights.normal[light], 0.0)
    return receiver * sender / square**2 * spread_factor(lights.spread[light], sender / np.sqrt(square))


def irradiance(point: np.ndarray, normal: np.ndarray, lights: Lights, light: int, side: int = 300) -> float:
    """W/m² at one receiver, from an unoccluded light of radiance 1.

    Far away, the sum over points of the light; nearby, over cosine-weighted directions at the receiver (Nusselt's
    disk): each where it converges.
    """
    size = max(np.linalg.norm(lights.axis_u[light]), np.linalg.norm(lights.axis_v[light]))
    if np.linalg.norm(lights.position[light] - point) > 1.5 * size:
        emitters, cell_area = grid_on_light(lights, light, side)
        return float(irradiance_per_area(point, normal, emitters, lights, light).sum() * cell_area)
    u, v = np.meshgrid(*[(np.arange(4 * side) + 0.5) / (2 * side) - 1.0] * 2)
    u, v = u[u**2 + v**2 < 1.0], v[u**2 + v**2 < 1.0]
    directions = np.column_stack([u, v, np.sqrt(1.0 - u**2 - v**2)]) @ np.stack([*orthonormal(normal), normal])
    cosine = -directions @ lights.normal[light]
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = ((point - lights.position[light]) @ lights.normal[light]) / cosine
        hit = point + distance[:, None] * directions - lights.position[light]
    axes = np.stack([lights.axis_u[light], lights.axis_v[light]])
    a, b = np.abs((hit @ axes.T) / (axes**2).sum(1)).T
    inside = (a**2 + b**2 < 0.25) if lights.shape[light] == LightShape.ELLIPSE else (a < 0.5) & (b < 0.5)
    factor = np.where(inside & (cosine > 0.0) & (distance > 0.0), spread_factor(lights.spread[light], cosine), 0.0)
    return float(factor.sum() / (2 * side) ** 2)
