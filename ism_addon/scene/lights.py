# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights: areas, points, spots and suns."""

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Any, Self

import numpy as np

from .arrays import UNIT_VECTOR, Arrays, array, array_specs, index
from .instances import MAX_LINK_GROUPS
from .limits import MAX_DISTANCE, MAX_EMISSION, MAX_SOFTNESS


class LightShape(IntEnum):
    """Blender's squares are rectangles, its disks ellipses. A point may have a radius, with which it is a sphere."""

    RECTANGLE = 0
    ELLIPSE = 1
    POINT = 2
    SPOT = 3
    SUN = 4


@dataclass(frozen=True, eq=False)
class Lights(Arrays):
    """Lights in world space. Fields that a shape does not use have valid values all the same; suns have no position."""

    #: LightShape.
    shape: np.ndarray = index("int32 L", into=len(LightShape))
    position: np.ndarray = array("float64 L 3", "m", max_abs=MAX_DISTANCE)
    #: Of areas, full width and height, scale included. Of spots, in proportion to the width and height of their cone,
    #: of unit length if it is circular.
    axis_u: np.ndarray = array("float64 L 3", "m", max_abs=MAX_DISTANCE)
    axis_v: np.ndarray = array("float64 L 3", "m", max_abs=MAX_DISTANCE)
    #: Of areas, the side that emits; of spots, their axis; of suns, the direction of their light.
    normal: np.ndarray = array("float64 L 3", UNIT_VECTOR)
    #: Radiance of areas along the normal, W/(sr m²); intensity of points, and of spots along their axis, W/sr;
    #: irradiance of suns on a surface that faces them, W/m².
    emission: np.ndarray = array("float32 L 3", "W/(sr m²), W/sr, W/m²", max_abs=MAX_EMISSION)
    #: Blender's spread of areas; pi: Lambertian. Of spots, the angle of their cone. Of suns, the angle at which they
    #: are seen, at most pi; 0: parallel light.
    spread: np.ndarray = array("float32 L", "rad", is_signed=False)
    #: Of spots: the fraction of the cone in which it fades out.
    blend: np.ndarray = array("float32 L", max_abs=1.0, is_signed=False)
    #: Of points and spots; 0: a point without extent.
    radius: np.ndarray = array("float64 L", "m", max_abs=MAX_DISTANCE, is_signed=False)
    #: Whether a point with a radius is a disk that faces the receiver, instead of a sphere.
    soft_falloff: np.ndarray = array("bool L")
    #: What Light Falloff nodes multiply radiance by: this power of the distance, and distance² / (distance² + smooth).
    falloff_power: np.ndarray = index("int32 L", into=3)
    falloff_smooth: np.ndarray = array("float32 L", "m²", max_abs=MAX_DISTANCE, is_signed=False)
    #: Of all but suns: how the radiance depends on the direction; -1: not at all. In the profile's space, a direction's
    #: x, y and -z are its scalar products with these axes.
    profile: np.ndarray = index("int32 L", into="light_profiles", first=-1)
    profile_axes: np.ndarray = array("float64 L 3 3", max_abs=MAX_DISTANCE)
    #: Of areas and spots: what the radiance is multiplied by at each point, or in each direction; -1: nothing.
    image: np.ndarray = index("int32 L", into="light_images", first=-1)
    casts_shadow: np.ndarray = array("bool L")
    #: Whether the camera sees it.
    visible_camera: np.ndarray = array("bool L")
    #: Factor of the size that only shadows see: of areas and points about their position, of suns on their angle.
    shadow_softness: np.ndarray = array("float32 L", max_abs=MAX_SOFTNESS, is_signed=False)
    #: Group of the instances that receive its light; -1: all.
    receivers: np.ndarray = index("int32 L", into=MAX_LINK_GROUPS, first=-1)
    #: Group of the instances that cast its shadows; -1: all.
    blockers: np.ndarray = index("int32 L", into=MAX_LINK_GROUPS, first=-1)

    def with_row(self, **values: Any) -> Self:
        """These lights and one more. Fields that are not given have values that a light does without."""
        row = UNUSED | values
        return type(self).of(
            **{name: np.concatenate([getattr(self, name), [row[name]]]) for name in array_specs(Lights)}
        )

    def select(self, rows: np.ndarray | slice) -> Self:
        """A table of these rows."""
        return replace(
            self,
            **{
                name: getattr(self, name)[rows]
                for name, spec in array_specs(type(self)).items()
                if spec.shapes[0][0] == "L"
            },
        )


#: Of fields that a light does without: no position, a direction of its own, no profile or image; and a plain shadow.
UNUSED: dict[str, Any] = {
    "position": (0.0, 0.0, 0.0),
    "axis_u": (1.0, 0.0, 0.0),
    "axis_v": (0.0, 1.0, 0.0),
    "normal": (0.0, 0.0, -1.0),
    "spread": np.pi,
    "blend": 0.0,
    "radius": 0.0,
    "soft_falloff": False,
    "falloff_power": 0,
    "falloff_smooth": 0.0,
    "profile": -1,
    "profile_axes": np.zeros((3, 3)),
    "image": -1,
    "casts_shadow": True,
    "visible_camera": False,
    "shadow_softness": 1.0,
    "receivers": -1,
    "blockers": -1,
}
