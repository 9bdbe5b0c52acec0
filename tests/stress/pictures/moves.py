# SPDX-License-Identifier: GPL-3.0-or-later
"""A similarity applied to a scene, its camera and the lengths in its settings.

A similarity moves, scales, rotates or mirrors; the picture stays the same.
"""

from dataclasses import replace

import numpy as np

from ism_addon.scene import Scene, View
from ism_addon.settings import Settings

Picture = tuple[Scene, View, Settings]


def transformed(picture: Picture, linear: np.ndarray, offset: np.ndarray | float = 0.0) -> Picture:
    """The picture after a similarity of the world, (3,3) and (3,). A reflection flips the picture left to right."""
    scene, view, settings = picture
    scale = float(np.cbrt(abs(np.linalg.det(linear))))
    rotation = linear / scale
    flip = np.diag([np.linalg.det(rotation), 1.0, 1.0])
    return (
        transformed_scene(scene, linear, offset),
        transformed_view(view, scale, rotation, flip, offset),
        scaled_settings(settings, scale),
    )


def transformed_scene(scene: Scene, linear: np.ndarray, offset: np.ndarray | float) -> Scene:
    """The scene with transformed instance matrices and lights; radiance is unchanged."""
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


def transformed_view(
    view: View, scale: float, rotation: np.ndarray, flip: np.ndarray, offset: np.ndarray | float
) -> View:
    """The view after the similarity. The camera's own axes stay right-handed: `flip` (3,3) undoes a reflection."""
    matrix = np.eye(4)
    matrix[:3, :3] = flip @ view.view_from_world[:3, :3] @ rotation.T
    matrix[:3, 3] = scale * flip @ view.view_from_world[:3, 3] - matrix[:3, :3] @ np.broadcast_to(offset, 3)
    flip_4x4, unscale = np.diag([*np.diag(flip), 1.0]), np.diag([1.0 / scale] * 3 + [1.0])
    clip_from_view = flip_4x4 @ view.clip_from_view @ unscale @ flip_4x4
    is_perspective = clip_from_view[3, 2] != 0.0  # then w is the depth, in m
    return replace(view, clip_from_view=clip_from_view * (scale if is_perspective else 1.0), view_from_world=matrix)


def scaled_settings(settings: Settings, scale: float) -> Settings:
    """The settings with lengths, which are in the scene's metres, scaled too."""
    return replace(settings, ssao=replace(settings.ssao, radius=scale * settings.ssao.radius))
