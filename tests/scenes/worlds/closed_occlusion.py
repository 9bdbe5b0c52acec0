# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes whose ambient occlusion has a closed form: a corner, a ball on a plane, a groove and a bowl."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ism_addon.scene import Scene, View
from ism_addon.settings import SSAO
from tests.scenes.small import sphere
from tests.support.small_scenes import look_at, make_scene, quad

CORNER_RADIUS, BALL_RADIUS = 0.5, 0.5
GROOVE_WIDTH, GROOVE_DEPTH, GROOVE_RADIUS = 1.0, 0.6, 1.0
BOWL_RADIUS, BOWL_REACH = 1.0, 0.8
#: m. Beyond all of the ball that a point in the picture sees.
FAR = 4.0


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """A scene, and where its surfaces are how open. A cone of 180°, without attenuation."""

    scene: Scene
    view: View
    radius: float
    open_at: Callable[[np.ndarray, np.ndarray], np.ndarray]  # (N,): of positions and normals (N,3); NaN: unknown

    @property
    def ssao(self) -> SSAO:
        """The settings for which the closed form holds. Surfaces are solid."""
        return SSAO(radius=self.radius, cone_angle=math.pi, attenuation=0.0, thickness=10.0)


def corner() -> ClosedForm:
    """A floor and a wall. Directions of a cosine-weighted hemisphere are even on a disc: a wall hides a segment."""
    floor, wall = quad((-40, -40, 0), (80, 0, 0), (0, 40, 0)), quad((-40, 0, 0), (80, 0, 0), (0, 0, 40))
    view = look_at((0.0, -2.0, 2.0), (0.0, 0.0, 0.0), (96, 96), math.radians(35.0))

    def open_at(position: np.ndarray, normal: np.ndarray) -> np.ndarray:
        distance = np.where(normal[:, 2] > 0.5, -position[:, 1], position[:, 2])
        t = np.clip(distance / CORNER_RADIUS, 0.0, 1.0)
        return 1.0 - (np.arccos(t) - t * np.sqrt(1.0 - t * t)) / np.pi

    return ClosedForm(make_scene([floor, wall], world=1.0), view, CORNER_RADIUS, open_at)


def ball_on_plane() -> ClosedForm:
    """A ball that touches a plane: from the plane it is a cap above the horizon."""
    plane = quad((-500, -500, 0), (1000, 0, 0), (0, 1000, 0))
    ball = sphere((0.0, 0.0, BALL_RADIUS), BALL_RADIUS, 96, 64)
    view = look_at((0.0, -3.0, 3.0), (0.0, 0.0, 0.2), (96, 96), math.radians(45.0))

    def open_at(position: np.ndarray, normal: np.ndarray) -> np.ndarray:
        square = (position[:, :2] ** 2).sum(1) + BALL_RADIUS**2
        return np.where(position[:, 2] < 1e-4, 1.0 - (BALL_RADIUS**2 / square) ** 1.5, np.nan)

    return ClosedForm(make_scene([plane, ball], world=1.0), view, FAR, open_at)


def groove() -> ClosedForm:
    """The floor of a long groove: it sees the sky between two edges, and along the groove what is beyond the radius."""
    half, depth, length = GROOVE_WIDTH / 2.0, GROOVE_DEPTH, 800.0
    floor = quad((-half, -length / 2, 0), (2 * half, 0, 0), (0, length, 0))
    left = quad((-half, -length / 2, 0), (0, length, 0), (0, 0, depth))
    right = quad((half, -length / 2, 0), (0, 0, depth), (0, length, 0))
    view = look_at((0.0, -0.3, 2.0), (0.0, 0.0, 0.0), (96, 96), math.radians(90.0))
    # Directions to one side, even on half of the disc: components across the groove and upwards.
    square, angle = np.meshgrid((np.arange(400) + 0.5) / 400, (np.arange(400) + 0.5) / 400 * np.pi - np.pi / 2)
    across, up = (np.sqrt(square) * np.cos(angle)).ravel(), np.sqrt(1.0 - square).ravel()

    to_wall = np.linspace(0.0, 2.0 * half, 65)
    distances = to_wall[:, None] / across  # to the wall, along each direction
    open_beside = np.where((distances * up > depth) | (distances > GROOVE_RADIUS), 0.5, 0.0).mean(1)

    def open_at(position: np.ndarray, normal: np.ndarray) -> np.ndarray:
        sides = (np.interp(half + side * position[:, 0], to_wall, open_beside) for side in (-1.0, 1.0))
        return np.where((normal[:, 2] > 0.9) & (np.abs(position[:, 1]) < 0.8), sum(sides), np.nan)

    return ClosedForm(make_scene([floor, left, right], world=1.0), view, GROOVE_RADIUS, open_at)


def bowl() -> ClosedForm:
    """The inside of a sphere of radius R. Within r, it hides directions up to the elevation arcsin(r / 2R), everywhere.

    Their part of a cosine-weighted hemisphere is the square of the elevation's sine.
    """
    view = look_at((0.0, 0.0, 0.3), (0.0, 0.01, -1.0), (160, 160), math.radians(90.0))
    open_part = 1.0 - (BOWL_REACH / (2.0 * BOWL_RADIUS)) ** 2

    def open_at(position: np.ndarray, normal: np.ndarray) -> np.ndarray:
        in_middle = np.hypot(position[:, 0], position[:, 1]) < 0.25  # all within r of these points is in the picture
        return np.where(in_middle, open_part, np.nan)

    scene = make_scene([sphere((0.0, 0.0, 0.0), BOWL_RADIUS, 64, 32)], world=1.0)
    return ClosedForm(scene, view, BOWL_REACH, open_at)


CLOSED_FORMS: dict[str, Callable[[], ClosedForm]] = {
    "corner": corner,
    "ball on a plane": ball_on_plane,
    "groove": groove,
    "bowl": bowl,
}
