# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's rows in a table of lights."""

from dataclasses import dataclass

import numpy as np

from ....scene import Lights, LightShape, World
from ...environment.map_sun import MapSun
from ...environment.map_tables import directions_by_light

#: The shape of the row of a world of even radiance, of one whose radiance a map gives, and of a sun in the map.
WORLD = len(LightShape) + 1
ENVIRONMENT = WORLD + 1
MAP_SUN = ENVIRONMENT + 1


@dataclass(frozen=True, eq=False)
class MapLight:
    """How bright the light of a map is, and where it comes from."""

    peak: float  # W/(sr m²): the radiance from everywhere that would light a surface as much as it does at most
    sun: MapSun | None  # not counted in `peak`
    leaves: np.ndarray  # (S,S) float32: light of the parts of a square of directions, see directions_by_light
    rotation: np.ndarray  # (3,3), from directions of the world to those of the square

    def directions(self, squares: np.ndarray) -> np.ndarray:
        """(N,3) unit: directions of equal parts of the light, for `squares` (N,2) in [0,1)."""
        return directions_by_light(self.leaves, squares) @ self.rotation


def is_world(lights: Lights) -> np.ndarray:
    """(L,) bool: which light is the world."""
    return np.isin(lights.shape, (WORLD, ENVIRONMENT))


def has_world(lights: Lights) -> bool:
    """Whether the world is one of the lights."""
    return bool(is_world(lights).any())


def world_row(lights: Lights) -> int:
    """The row of the world."""
    return int(np.flatnonzero(is_world(lights))[0])


def with_world(lights: Lights, world: World, of_map: MapLight | None = None, casts_shadow: bool = True) -> Lights:
    """A table of lights, and after them the world; `of_map`: if a map gives its radiance.

    Without shadows, a world of even radiance is none of the lights.
    """
    if of_map is None:
        return lights.with_row(shape=WORLD, emission=world.radiance) if casts_shadow else lights
    sun = of_map.sun
    if sun is not None:
        spread = sun.angular_diameter
        lights = lights.with_row(shape=MAP_SUN, normal=-sun.direction, emission=sun.irradiance, spread=spread)
    return lights.with_row(shape=ENVIRONMENT, emission=np.full(3, of_map.peak), casts_shadow=casts_shadow)
