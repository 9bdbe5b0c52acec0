# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of pictures, and what they are compared with."""

from dataclasses import replace

import numpy as np

from ism_addon.scene import Scene


def relative_difference(picture: np.ndarray, other: np.ndarray) -> float:
    """Root mean square of the difference of two (H,W,4), over the other's mean; infinite where it is not finite."""
    difference, mean = picture[..., :3] - other[..., :3], float(np.abs(other[..., :3]).mean())
    off = float(np.sqrt((difference.astype(np.float64) ** 2).mean()))
    return off / mean if np.isfinite(off) and mean > 0.0 else (0.0 if off == 0.0 else np.inf)


def unshadowed(scene: Scene) -> Scene:
    """The same, without shadows."""
    return replace(scene, lights=replace(scene.lights, casts_shadow=np.zeros(len(scene.lights.shape), bool)))
