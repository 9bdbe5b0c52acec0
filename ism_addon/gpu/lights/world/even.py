# SPDX-License-Identifier: GPL-3.0-or-later
"""The world as a light: of the same radiance from all directions. It is sampled in proportion to the cosine."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np

from ....color import REC709, luminance
from ....scene import Lights
from ...culling.receiver_region import ReceiverRegion
from ...culling.surface_bounds import SurfaceBounds
from ..light_records import light_records
from ..sun import RAY_LENGTH, SunLight
from .table import WORLD


@dataclass(frozen=True)
class WorldLightBounds:
    """K worlds by what bounds them: float32, a column (K,1)."""

    luminance: np.ndarray  # of the irradiance

    @classmethod
    def of(cls, lights: Lights, working_space: str = REC709) -> Self:
        column = np.pi * (np.abs(lights.emission) @ luminance(working_space))
        return cls(column[:, None].astype(np.float32))

    @property
    def peak(self) -> np.ndarray:
        return self.luminance

    def __getitem__(self, rows: slice) -> Self:
        return type(self)(self.luminance[rows])

    def irradiance(self, surfaces: SurfaceBounds) -> tuple[np.ndarray, np.ndarray]:
        """See LightBounds."""
        bound = self.luminance * surfaces.exists
        return bound, bound


class WorldLight(SunLight):
    """See LightType. Its emission is radiance. Otherwise it is like a sun whose cap is all directions."""

    name = "world"
    shapes: tuple[int, ...] = (WORLD,)
    glsl = Path(__file__).with_suffix(".glsl")

    def records(self, lights: Lights, anchor: np.ndarray) -> np.ndarray:
        return light_records(lights, anchor)

    def bounds(self, lights: Lights, anchor: np.ndarray, working_space: str) -> Any:
        return WorldLightBounds.of(lights, working_space)

    def shadow_ends(self, lights: Lights, anchor: np.ndarray, receivers: np.ndarray) -> np.ndarray:
        ends = np.array([-RAY_LENGTH, RAY_LENGTH])[:, None, None, None]
        return receivers[:, :, None] + np.repeat(ends, len(lights.shape), 2)

    def virtual_lights(self, lights: Lights, row: int, squares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        cosine, angle = 2.0 * squares[:, 0] - 1.0, 2.0 * np.pi * squares[:, 1]
        sine = np.sqrt(1.0 - cosine * cosine)
        directions = np.stack([sine * np.cos(angle), sine * np.sin(angle), cosine], 1)
        return np.zeros_like(directions), directions

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
        """The same for all: each is seen from some direction."""
        return np.ones(len(points), np.float32)

    def variant(self, lights: Lights) -> dict[str, np.ndarray]:
        return {}
