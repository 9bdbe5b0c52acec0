# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material needs of meshes and of their instances."""

from typing import NamedTuple

from .attributes import Attribute
from .instance_attributes import InstanceAttribute


class Needs(NamedTuple):
    """What a material's graphs and images read."""

    uv_layer: str | None = None  # "": the one that renders
    attributes: tuple[Attribute, ...] = ()
    objects: bool = False  # of instances: their color, index and random number
    instance_attributes: tuple[InstanceAttribute, ...] = ()


NOTHING = Needs()
