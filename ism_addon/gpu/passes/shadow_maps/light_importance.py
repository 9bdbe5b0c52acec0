# SPDX-License-Identifier: GPL-3.0-or-later
"""Importance of lights: the fraction of the virtual lights that each should get.

Virtual lights estimate a light's visibility. Their error is in its penumbrae, whose width grows with the solid angle of
the light, and is in proportion to its irradiance there. Of a given number of virtual lights, the allocation in
proportion to the standard deviation of each light's error has the least variance (Neyman 1934). The mean is over all of
the scene's surfaces, so that no map has to be drawn again when the camera moves. A mean over the visible ones would
give less noise (lamps: RMSE 4 % less after a sample), but nine of ten rotations of the camera by a hundredth of the
picture would change the allocation among twenty lights, and so all maps.
"""

import numpy as np

from ....resources import LIGHT_IMPORTANCE, POINT_CLOUD
from ....sampling.dimensions import Dimension, draw
from ....sampling.point_cloud import PointCloud
from ....scene import Change, Lights
from ...culling.surface_bounds import SurfaceBounds
from ...frame import Frame, Pass, outputs
from ...lights import bounds_with_falloff, by_type

#: Points of the cloud at which irradiance is estimated. See `dev.py bench constants` in docs/benchmarks.md.
IMPORTANCE_POINTS = 4096

#: Smallest relative size of a light: a light without penumbrae has the errors of imperfect maps all the same. In the
#: scene objects with point lights, one of them without a radius, the RMSE of one sample over the mean is 0.212 at 0,
#: and 0.176 to 0.178 from 0.003 to 0.5.
MIN_SIZE = 0.005


def importance(cloud: PointCloud, lights: Lights, anchor: np.ndarray, working_space: str) -> np.ndarray:
    """(L,): standard deviation of the error of one virtual light of each light, relative to the others'."""
    index = np.arange(IMPORTANCE_POINTS if len(cloud) else 0)
    chosen = (draw(Dimension.IMPORTANCE_POINT, point=index)[:, 0] * len(cloud)).astype(int)
    points, normals = cloud.positions[chosen].T, cloud.normals[chosen].T
    either_side = SurfaceBounds.around(np.tile(points, 2), np.concatenate([normals, -normals], 1))
    estimates = np.zeros((len(lights.shape), 2 * len(chosen)), np.float32)
    peaks = np.zeros((len(lights.shape), 1), np.float32)
    for light_type, rows, type_lights in by_type(lights):
        type_bounds = bounds_with_falloff(light_type, type_lights, anchor, working_space)
        estimates[rows], peaks[rows] = type_bounds.irradiance(either_side)[1], type_bounds.peak
    total = estimates.sum(0)
    if not total.any():
        return np.ones(len(estimates))
    fraction = estimates / np.maximum(total, total[total > 0.0].mean())
    relative = np.divide(estimates, peaks, out=np.zeros_like(estimates), where=peaks > 0.0)
    size = np.maximum(np.sqrt(np.minimum(relative, 1.0)), MIN_SIZE)
    return np.sqrt((fraction * fraction * size).sum(1, dtype=np.float64))


class WeighLights(Pass):
    """Estimate the error of a virtual light of each light."""

    inputs = POINT_CLOUD, Change.LIGHTS
    outputs = outputs(LIGHT_IMPORTANCE)

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows

    def execute(self, frame: Frame) -> None:
        scene = frame.scene
        frame[LIGHT_IMPORTANCE] = importance(frame[POINT_CLOUD], scene.lights, frame.anchor, scene.working_space)
