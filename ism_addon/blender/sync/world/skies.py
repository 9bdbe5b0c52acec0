# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads Sky Texture nodes: the sky as an image, and its sun as a light."""

from functools import lru_cache
from typing import Any, NamedTuple

import bpy
import numpy as np

from ....color import REC709, between_spaces
from ....scene import Encoding, Image, Lights, LightShape
from ....scene.limits import MAX_EMISSION, is_within
from ....shading.sky import Sky, SkyModel, Sun, sky_image, sun, sun_irradiance
from ..materials import images, nodes
from ..materials.image_reader import ImageReader

#: Columns of a sky's image. Its sun is no part of it.
COLUMNS = 1024
MAX_TEXEL = 65504.0  # of 16-bit floats

#: Fields of Sky by the node's properties, where names differ between releases.
PROPERTIES = {"aerosol_density": ("aerosol_density", "dust_density")}


class Disc(NamedTuple):
    """The sun of a sky."""

    sun: Sun
    irradiance: np.ndarray  # (3,) of a surface that faces it, in the working space, W/m²


class SkySun(NamedTuple):
    """A sky's sun, as much as the world's nodes leave of it."""

    sun: Sun
    irradiance: np.ndarray  # as of Disc
    visible: bool  # for the camera


class Skies:
    """The Sky Textures of a world: images of an ImageReader, and the suns of those that have one, by image."""

    def __init__(self, image_reader: ImageReader) -> None:
        self._images = image_reader
        self.indices, self.discs = set[int](), dict[int, Disc]()
        self.is_moved = False  # whether nodes give the vector of any sky that has a sun

    def index_of(self, node: bpy.types.ShaderNodeTexSky) -> int:
        """The index of a node's image."""
        sky = read(node)
        index = self._images.index_of_made(repr(sky), lambda: image_of(sky))
        self.indices.add(index)
        disc = disc_of(sky, images.working_space())
        if disc is not None:
            self.discs[index] = disc
            self.is_moved |= any(nodes.source(each) is not None for each in node.inputs)
        return index


def read(node: bpy.types.ShaderNodeTexSky) -> Sky:
    """The settings of a node."""
    values: dict[str, Any] = {"model": SkyModel(node.sky_type)}
    for name in Sky.__dataclass_fields__:
        found = next((each for each in PROPERTIES.get(name, (name,)) if hasattr(node, each)), None)
        if found is not None:
            value = getattr(node, found)
            values[name] = tuple(value) if name == "sun_direction" else value
    return Sky(**values)


def image_of(sky: Sky) -> Image:
    """The sky without its sun, as an environment texture would have it."""
    colors = sky_image(sky, COLUMNS) @ between_spaces(images.working_space(), REC709).T
    texels = np.ones((*colors.shape[:2], 4), np.float16)
    texels[..., :3] = np.clip(np.nan_to_num(colors), 0.0, MAX_TEXEL)
    return Image(texels, encoding=Encoding.FLOAT)


@lru_cache(maxsize=4)  # a world is read at each change of the scene
def disc_of(sky: Sky, working_space: str) -> Disc | None:
    """The sun of a sky, if it has one."""
    disc = sun(sky)
    if disc is None:
        return None
    return Disc(disc, np.maximum(between_spaces(working_space, REC709) @ sun_irradiance(disc), 0.0))


def with_suns(lights: Lights, suns: tuple[SkySun, ...]) -> Lights:
    """A table of lights, and after them the suns of skies."""
    for each in suns:
        if each.irradiance.any() and is_within(each.irradiance, MAX_EMISSION).all():
            lights = lights.with_row(
                shape=LightShape.SUN,
                normal=-each.sun.direction,
                emission=each.irradiance,
                spread=each.sun.angular_diameter,
                visible_camera=each.visible,
            )
    return lights
