# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's rows in a table of lights."""

from typing import NamedTuple

import numpy as np

from ....scene import Lights, LightShape, World
from ...environment.map_sun import MapSun

#: The shape of the row of a world of even radiance, of one whose radiance a map gives, and of a sun in the map.
WORLD = len(LightShape) + 1
ENVIRONMENT = WORLD + 1
MAP_SUN = ENVIRONMENT + 1


class MapLight(NamedTuple):
    """How bright the light of a map is."""

    peak: float  # W/(sr m²): the radiance from everywhere that would light a surface as much as it does at most
    sun: MapSun | None  # not counted in `peak`


def is_world(lights: Lights) -> np.ndarray:
    """(L,) bool: which light is the world."""
    return np.isin(lights.shape, (WORLD, ENVIRONMENT))


def has_world(lights: Lights) -> bool:
    """Whether the world is one of the lights."""
    return bool(is_world(lights).any())


def world_row(lights: Lights) -> int:
    """The row of the world."""
    return int(np.flatnonzero(is_world(lights))[0])


def with_world(lights: Lights, world: World, of_map: MapLight | None = None) -> Lights:
    """A table of lights, and after them the world; `of_map`: if a map gives its radiance."""
    if of_map is None:
        return lights.with_row(shape=WORLD, emission=world.radiance)
    sun = of_map.sun
    if sun is not None:
        spread = sun.angular_diameter
        lights = lights.with_row(shape=MAP_SUN, normal=-sun.direction, emission=sun.irradiance, spread=spread)
    return lights.with_row(shape=ENVIRONMENT, emission=np.full(3, of_map.peak))
