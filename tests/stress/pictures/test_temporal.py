# SPDX-License-Identifier: GPL-3.0-or-later
"""Flicker: as the camera or a light moves, pictures change at most twice as much as those of Cycles.

Ours have 16 samples, as by default; those of Cycles have 1024. All frames have the same seed.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.scene import Scene, View
from ism_addon.settings import SSAO, Quality, Settings
from tests.scenes.cycles import direct_light
from tests.scenes.small import SMALL
from tests.stress.pictures.into_blender import into_blender, out_of_blender
from tests.support.small_scenes import draw, look_at

SETTINGS = Settings(ssao=SSAO(enabled=False), quality=Quality(samples=16, error_threshold=0.0))
FILTER_WIDTH = 1.5  # px
SIZE = 48, 36


def camera_moves(time: float) -> tuple[Scene, View]:
    """The camera orbits the pillars; at `time` 1 by 0.3 rad, about a twentieth of a circle."""
    scene, _ = SMALL["pillar field"](*SIZE)
    angle = -1.0 + 0.3 * time
    return scene, look_at((4.9 * np.cos(angle), 4.9 * np.sin(angle), 2.7), (0.0, 0.0, 0.4), SIZE)


def light_moves(time: float) -> tuple[Scene, View]:
    """The light moves over the pillars; at `time` 1 by about a metre."""
    scene, view = SMALL["pillar field"](*SIZE)
    position = scene.lights.position + time * np.array([1.0, 0.3, 0.0])
    return replace(scene, lights=replace(scene.lights, position=position)), view


def frame_change(frames: list[np.ndarray]) -> float:
    """Root mean square of the differences between successive frames, over the mean."""
    differences = np.diff(np.array(frames)[..., :3].astype(np.float64), axis=0)
    return float(np.sqrt((differences**2).mean()) / np.mean(np.array(frames)[..., :3]))


@pytest.mark.parametrize("moves", [camera_moves, light_moves])
def test_change_from_frame_to_frame(device, assert_within, frames, moves: Callable[[float], tuple[Scene, View]]):
    """`time` grows by 0.01 a frame; one renderer draws all frames."""
    from ism_addon.gpu.renderer import Renderer

    renderer, ours, cycles = Renderer(device), [], []
    for frame in range(frames):
        into_blender(*moves(0.01 * frame))
        cycles.append(direct_light(1024, FILTER_WIDTH))
        ours.append(draw(device, *out_of_blender(), SETTINGS, renderer).color)
    assert_within(frame_change(ours) / frame_change(cycles), 2.0)
