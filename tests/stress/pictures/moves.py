# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene elsewhere, larger, turned or mirrored, with its camera and the lengths in its settings: the same picture."""

from dataclasses import replace

import numpy as np

from ism_addon.scene import Scene, View
from ism_addon.settings import Settings

Picture = tuple[Scene, View, Settings]


def moved(picture: Picture, linear: np.ndarray, offset: np.ndarray | float = 0.0) -> Picture:
    """The picture of a world that a similarity, (3,3) and (3,), has moved. A mirrored one is flipped left to right."""
    scene, view, settings = picture
    scale = float(np.cbrt(abs(np.linalg.det(linear))))
    turn = linear / scale
    hand = np.diag([np.linalg.det(turn), 1.0, 1.0])
    return moved_scene(scene, linear, offset), moved_view(view, scale, turn, hand, offset), scaled(settings, scale)


def moved_scene(scene: Scene, linear: np.ndarray, offset: np.ndarray | float) -> Scene:
    """All things by their instances' matrices and the lights' places; radiance stays as it is."""
    matrices, lights = np.copy(scene.instances.world_from_object), scene.lights
    matrices[:, :3] = linear @ matrices[:, :3]
    matrices[:, :3, 3] += offset
    scale = np.cbrt(abs(np.linalg.det(linear)))
    return replace(
        scene,
        instances=replace(scene.instances, world_from_object=matrices),
        lights=replace(
            lights,
            position=lights.position @ linear.T + offset,
            axis_u=lights.axis_u @ linear.T,
            axis_v=lights.axis_v @ linear.T,
            normal=lights.normal @ linear.T / scale,
        ),
    )


def moved_view(view: View, scale: float, turn: np.ndarray, hand: np.ndarray, offset: np.ndarray | float) -> View:
    """A camera must not be mirrored itself, hence `hand` (3,3)."""
    matrix = np.eye(4)
    matrix[:3, :3] = hand @ view.view_from_world[:3, :3] @ turn.T
    matrix[:3, 3] = scale * hand @ view.view_from_world[:3, 3] - matrix[:3, :3] @ np.broadcast_to(offset, 3)
    flip, smaller = np.diag([*np.diag(hand), 1.0]), np.diag([1.0 / scale] * 3 + [1.0])
    clip_from_view = flip @ view.clip_from_view @ smaller @ flip
    perspective = clip_from_view[3, 2] != 0.0  # then w is the depth, in m
    return replace(view, clip_from_view=clip_from_view * (scale if perspective else 1.0), view_from_world=matrix)


def scaled(settings: Settings, scale: float) -> Settings:
    """Lengths of settings are in the scene's metres."""
    return replace(settings, ssao=replace(settings.ssao, radius=scale * settings.ssao.radius))
