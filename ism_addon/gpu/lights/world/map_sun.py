# SPDX-License-Identifier: GPL-3.0-or-later
"""The sun in a map of the world's radiance as a light, see gpu/environment/map_sun.py."""

from pathlib import Path

from ....scene import Lights
from ..sun import SunLight
from .table import MAP_SUN


class MapSunLight(SunLight):
    """See LightType. It lights surfaces as an even disc would; shadow rays go to where the map is bright."""

    name = "map_sun"
    shapes: tuple[int, ...] = (MAP_SUN,)
    glsl = Path(__file__).with_suffix(".glsl")

    def is_round(self, lights: Lights, row: int) -> bool:
        return False
