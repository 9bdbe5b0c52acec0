# SPDX-License-Identifier: GPL-3.0-or-later
"""The world as a light whose radiance a map gives, see gpu/environment/map_tables.py."""

from pathlib import Path

from .even import WorldLight
from .table import ENVIRONMENT


class EnvironmentLight(WorldLight):
    """See LightType. Its emission is the radiance in units of which the map's texels are."""

    name = "environment"
    shapes: tuple[int, ...] = (ENVIRONMENT,)
    glsl = Path(__file__).with_suffix(".glsl")
