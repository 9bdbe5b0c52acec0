# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's row in a table of lights."""

import numpy as np

from ....scene import Lights, LightShape, World

#: The shape of the row of a world of even radiance, and of one whose radiance a map gives.
WORLD = len(LightShape) + 1
ENVIRONMENT = WORLD + 1


def is_world(lights: Lights) -> np.ndarray:
    """(L,) bool: which light is the world."""
    return np.isin(lights.shape, (WORLD, ENVIRONMENT))


def has_world(lights: Lights) -> bool:
    """Whether the world is one of the lights."""
    return bool(is_world(lights).any())


def world_row(lights: Lights) -> int:
    """The row of the world."""
    return int(np.flatnonzero(is_world(lights))[0])


def with_world(lights: Lights, world: World, peak: float | None = None) -> Lights:
    """A table of lights, and after them the world.

    `peak`: if a map gives its radiance, the radiance from everywhere that would light a surface as much as the map
    does at most, as luminance.
    """
    if peak is None:
        return lights.with_row(shape=WORLD, emission=world.radiance)
    return lights.with_row(shape=ENVIRONMENT, emission=np.full(3, peak))
