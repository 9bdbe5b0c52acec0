# SPDX-License-Identifier: GPL-3.0-or-later
"""A light type for tests only, by the interface of ism_addon/gpu/lights: a point light with an intensity in W/sr."""

from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np

from ism_addon.color import luminance
from ism_addon.gpu.culling.receiver_region import ReceiverRegion
from ism_addon.gpu.culling.surface_bounds import SurfaceBounds
from ism_addon.gpu.lights.light_records import light_records
from ism_addon.gpu.lights.world.table import MAP_SUN
from ism_addon.scene import Lights

#: Its value in Lights.shape.
BULB = MAP_SUN + 1


@dataclass
class BulbBounds:
    """See LightBounds. The bound is the irradiance at the point of a box nearest to the bulb."""

    position: np.ndarray  # (K,3) m
    intensity: np.ndarray  # (K,) luminance

    def irradiance(self, surfaces: SurfaceBounds) -> tuple[np.ndarray, np.ndarray]:
        nearest = np.clip(self.position[:, :, None], surfaces.low, surfaces.high) - self.position[:, :, None]
        centre = (surfaces.low + surfaces.high) / 2.0 - self.position[:, :, None]
        with np.errstate(divide="ignore"):
            bounds = [self.intensity[:, None] * surfaces.exists / (to * to).sum(1) for to in (nearest, centre)]
        return tuple(np.minimum(each, 1e30).astype(np.float32) for each in bounds)

    @property
    def peak(self) -> np.ndarray:
        return np.pi * self.intensity[:, None]

    def __getitem__(self, rows: slice) -> Self:
        return type(self)(self.position[rows], self.intensity[rows])


class Bulb:
    """See LightType. Lights.emission holds its intensity."""

    name = "bulb"
    shapes = (BULB,)
    glsl = Path(__file__).with_suffix(".glsl")
    min_virtual_lights = 1
    parallel = False
    max_rays = 1

    def records(self, lights: Lights, anchor: np.ndarray) -> np.ndarray:
        table = light_records(lights, anchor)
        table["normal"] = 0.0, 0.0, -1.0
        return table

    def bounds(self, lights: Lights, anchor: np.ndarray, working_space: str) -> BulbBounds:
        return BulbBounds(lights.position - anchor, np.abs(lights.emission) @ luminance(working_space))

    def shadow_ends(self, lights: Lights, anchor: np.ndarray, receivers: np.ndarray) -> np.ndarray:
        return np.stack([(lights.position - anchor).T] * 2)[..., None]

    def heights(self, lights: Lights, anchor: np.ndarray, boxes: np.ndarray) -> np.ndarray:
        return np.full((boxes.shape[2], len(lights.shape)), np.inf)

    def is_narrow(self, lights: Lights) -> np.ndarray:
        return np.zeros(len(lights.shape), bool)

    def is_exact(self, lights: Lights, row: int) -> bool:
        return True

    def is_hard(self, lights: Lights, row: int) -> bool:
        return True

    def is_round(self, lights: Lights, row: int) -> bool:
        return False

    def virtual_lights(self, lights: Lights, row: int, squares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """All at its position, facing down."""
        return np.zeros((len(squares), 3)), np.tile((0.0, 0.0, -1.0), (len(squares), 1))

    def solid_angles(
        self,
        lights: Lights,
        row: int,
        anchor: np.ndarray,
        points: np.ndarray,
        normals: np.ndarray,
        area: float,
        region: ReceiverRegion | None,
    ) -> np.ndarray:
        to = points - (lights.position[row] - anchor).astype(np.float32)
        return 1.0 / ((to * to).sum(1) + np.float32(1e-12))

    def variant(self, lights: Lights) -> dict[str, np.ndarray]:
        return {}
