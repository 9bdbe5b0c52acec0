# SPDX-License-Identifier: GPL-3.0-or-later
"""The interface of types of light in Python."""

from pathlib import Path
from typing import Protocol

import numpy as np

from ...scene import Lights
from ..culling.receiver_region import ReceiverRegion
from ..culling.surface_bounds import SurfaceBounds


class LightBounds(Protocol):
    """Bounds of K lights of one type."""

    def irradiance(self, surfaces: SurfaceBounds) -> tuple[np.ndarray, np.ndarray]:
        """Luminance of the unshadowed irradiance: an upper bound and an estimate, each (K,N) float32."""

    @property
    def peak(self) -> np.ndarray:
        """(K,1) luminance of the irradiance of a light that fills a receiver's hemisphere."""

    def __getitem__(self, rows: slice) -> "LightBounds": ...


class LightType(Protocol):
    """Lights with certain values of Lights.shape. Tables `lights` have only rows of these, except if there is a `row`.

    Its GLSL file has the functions of GLSL_INTERFACE, with `name` as prefix: area_irradiance, …
    """

    name: str
    shapes: tuple[int, ...]
    glsl: Path
    #: Number of virtual lights that together emit into all directions into which the light does.
    min_virtual_lights: int
    #: Whether virtual lights emit parallel light, into the region of the receivers.
    parallel: bool
    #: Shadow rays that a pixel traces to it in a sample at most.
    max_rays: int

    def records(self, lights: Lights, anchor: np.ndarray) -> np.ndarray:
        """Rows (K,) of LIGHT, about the anchor (3,) m."""

    def bounds(self, lights: Lights, anchor: np.ndarray, working_space: str) -> LightBounds:
        """Bounds for culling, about the anchor (3,) m."""

    def shadow_ends(self, lights: Lights, anchor: np.ndarray, receivers: np.ndarray) -> np.ndarray:
        """(2,3,K,B) m: low and high corners of the boxes in which shadow rays from boxes (2,3,B) end, about the anchor.

        B is 1 if they are the same for all boxes.
        """

    def heights(self, lights: Lights, anchor: np.ndarray, boxes: np.ndarray) -> np.ndarray:
        """(N,K) m: how far boxes (2,3,N) extend into the half space that a light can illuminate; <= 0: not at all."""

    def is_narrow(self, lights: Lights) -> np.ndarray:
        """(K,) bool: whether a light may illuminate points between receivers that it does not illuminate."""

    def is_exact(self, lights: Lights, row: int) -> bool:
        """Whether its irradiance in GLSL is exact. Otherwise shadow rays correct its error, if it casts shadows."""

    def is_hard(self, lights: Lights, row: int) -> bool:
        """Whether it has no size: one shadow ray decides whether a point is lit."""

    def is_round(self, lights: Lights, row: int) -> bool:
        """Whether samples lie on a disc."""

    def virtual_lights(self, lights: Lights, row: int, squares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points on a light for `squares` (N,2) in [0,1): offsets (N,3) m from its position, and unit vectors (N,3).

        A virtual light emits into the hemisphere around its vector, or, if it is parallel, along the vector.
        """

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
        """(P,) float32, proportional to the solid angles of occluders of `area` m² each, as seen from a light.

        They lie at points (P,3) about the anchor, with normals (P,3). 0 for those that cannot occlude the light.
        `region` contains all receivers, if the light is parallel.
        """

    def variant(self, lights: Lights) -> dict[str, np.ndarray]:
        """(L,) bool each: constants of a shader for one light, if it is of this type. A mixed shader has all."""
