# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads Sky Texture nodes: the sky as an image, and its sun as a light."""

from typing import Any, NamedTuple

import bpy
import numpy as np

from ....color import REC709, between_spaces
from ....scene import Encoding, Image, Lights, LightShape
from ....scene.limits import MAX_EMISSION, is_within
from ....shading.sky import Sky, SkyModel, Sun, sky_image, sun_irradiance
from ..materials import images

#: Columns of a sky's image. Its sun is no part of it.
COLUMNS = 1024
MAX_TEXEL = 65504.0  # of 16-bit floats

#: Fields of Sky by the node's properties, where names differ between releases.
PROPERTIES = {"aerosol_density": ("aerosol_density", "dust_density")}


class SkySun(NamedTuple):
    """A sky's sun, as much as the world's nodes leave of it."""

    disc: Sun
    irradiance: np.ndarray  # (3,) W/m² on a surface that faces it
    visible: bool  # for the camera


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


def irradiance_of(disc: Sun) -> np.ndarray:
    """(3,) of a surface that faces the sun, in the working space, W/m²."""
    result: np.ndarray = between_spaces(images.working_space(), REC709) @ sun_irradiance(disc)
    return np.maximum(result, 0.0)


def with_suns(lights: Lights, suns: tuple[SkySun, ...]) -> Lights:
    """A table of lights, and after them the suns of skies."""
    rows = [row_of(each) for each in suns if each.irradiance.any() and is_within(each.irradiance, MAX_EMISSION).all()]
    if not rows:
        return lights
    return Lights.of(**{name: [*getattr(lights, name), *(row[name] for row in rows)] for name in rows[0]})


def row_of(sun: SkySun) -> dict[str, Any]:
    """A sun in a table of lights."""
    return {
        "shape": LightShape.SUN,
        "position": np.zeros(3),
        "axis_u": (1.0, 0.0, 0.0),
        "axis_v": (0.0, 1.0, 0.0),
        "normal": -sun.disc.direction,
        "emission": sun.irradiance,
        "spread": sun.disc.angular_diameter,
        "blend": 0.0,
        "radius": 0.0,
        "soft_falloff": False,
        "falloff_power": 0,
        "falloff_smooth": 0.0,
        "profile": -1,
        "profile_axes": np.zeros((3, 3)),
        "image": -1,
        "casts_shadow": True,
        "visible_camera": sun.visible,
        "shadow_softness": 1.0,
        "receivers": -1,
        "blockers": -1,
    }
