# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of a scene's lights when some of them are emissive meshes."""

from dataclasses import dataclass

import numpy as np

from ...scene import Lights, LightShape
from ...scene.arrays import array

#: The shape of lights of emissive triangles.
EMISSIVE_MESH = len(LightShape)

#: A light with more triangles than this has a light BVH, and its irradiance is an estimate.
MAX_EXACT_TRIANGLES = 16


@dataclass(frozen=True, eq=False)
class EmissiveLights(Lights):
    """Lamps, and lights of emissive triangles; the latter have a sphere around them as position and radius."""

    #: Range of its triangles.
    first_triangle: np.ndarray = array("int32 L")
    triangle_count: np.ndarray = array("int32 L")
    #: Its light BVH: node k, from 1 on, is row first_node + k; leaf j has the j-th part of the triangles. 0: none.
    first_node: np.ndarray = array("int32 L")
    leaves: np.ndarray = array("int32 L")
    #: Upper bound of its area as seen from any direction. Triangles count by their luminance relative to the light's.
    projected_area: np.ndarray = array("float64 L", "m²")
    #: Whether its triangles differ in radiance, and the largest of their relative luminances.
    varies: np.ndarray = array("bool L")
    brightest: np.ndarray = array("float64 L")
    #: Corners of a box outside of which one-sided triangles emit from one side only.
    enclosure: np.ndarray = array("float64 L 2 3", "m")
    #: Triangles in world space. Those that fill up a leaf have no area.
    corners: np.ndarray = array("float64 T 3 3", "m")
    one_sided: np.ndarray = array("bool T")
    #: Of triangles, if any light varies: a color of luminance 1 that the light's emission is multiplied by, and the
    #: relative luminance.
    colors: np.ndarray = array("float64 C 4")
    #: Nodes of all light BVHs: see LightBVH.
    node_centre: np.ndarray = array("float64 N 3", "m")
    node_radius: np.ndarray = array("float64 N", "m")
    node_area: np.ndarray = array("float64 N", "m²")
    node_normal: np.ndarray = array("float64 N 3", "m²")
    node_normal_sine: np.ndarray = array("float64 N")
    node_normal_normal: np.ndarray = array("float64 N 6", "m²")
    node_position_position: np.ndarray = array("float64 N 6", "m⁴")
    node_normal_position: np.ndarray = array("float64 N 9", "m³")
    node_one_sided: np.ndarray = array("bool N")
    #: If any light varies.
    node_color: np.ndarray = array("float64 K 3")
