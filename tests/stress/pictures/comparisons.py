# SPDX-License-Identifier: GPL-3.0-or-later
"""The error of a picture against another, and a scene without shadows to compare with."""

from dataclasses import replace

import numpy as np

from ism_addon.scene import Scene


def relative_difference(picture: np.ndarray, other: np.ndarray) -> float:
    """RMSE of two pictures (H,W,4) over the mean of `other`; infinite if a difference is not finite."""
    difference, mean = picture[..., :3] - other[..., :3], float(np.abs(other[..., :3]).mean())
    rmse = float(np.sqrt((difference.astype(np.float64) ** 2).mean()))
    return rmse / mean if np.isfinite(rmse) and mean > 0.0 else (0.0 if rmse == 0.0 else np.inf)


def without_shadows(scene: Scene) -> Scene:
    """The scene with lights that cast no shadows."""
    return replace(scene, lights=replace(scene.lights, casts_shadow=np.zeros(len(scene.lights.shape), bool)))
