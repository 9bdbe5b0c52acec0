# SPDX-License-Identifier: GPL-3.0-or-later
"""As the camera or a light moves, pictures change from frame to frame by no more than a factor beyond what Cycles' do.

Ours have 16 samples, as by default, and Cycles' 1024, all with one seed.
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
FILTER = 1.5  # px
SIZE = 48, 36


def camera_moves(part: float) -> tuple[Scene, View]:
    """About the pillars, a twentieth of a turn."""
    scene, _ = SMALL["pillar field"](*SIZE)
    angle = -1.0 + 0.3 * part
    return scene, look_at((4.9 * np.cos(angle), 4.9 * np.sin(angle), 2.7), (0.0, 0.0, 0.4), SIZE)


def light_moves(part: float) -> tuple[Scene, View]:
    """A metre, over the pillars."""
    scene, view = SMALL["pillar field"](*SIZE)
    position = scene.lights.position + part * np.array([1.0, 0.3, 0.0])
    return replace(scene, lights=replace(scene.lights, position=position)), view


def changes(frames: list[np.ndarray]) -> float:
    """Root mean square of what one frame differs from the one before, over the mean."""
    steps = np.diff(np.array(frames)[..., :3].astype(np.float64), axis=0)
    return float(np.sqrt((steps**2).mean()) / np.mean(np.array(frames)[..., :3]))


@pytest.mark.parametrize("moves", [camera_moves, light_moves])
def test_change_from_frame_to_frame(device, within, frames, moves: Callable[[float], tuple[Scene, View]]):
    """Steps of a hundredth of the way each, by one renderer."""
    from ism_addon.gpu.renderer import Renderer

    renderer, ours, theirs = Renderer(device), [], []
    for frame in range(frames):
        into_blender(*moves(0.01 * frame))
        theirs.append(direct_light(1024, FILTER))
        ours.append(draw(device, *out_of_blender(), SETTINGS, renderer).color)
    within(changes(ours) / changes(theirs), 2.0)
