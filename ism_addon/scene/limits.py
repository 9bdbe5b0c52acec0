# SPDX-License-Identifier: GPL-3.0-or-later
"""How large a scene's numbers may be, so that float32 still holds their squares after a matrix has moved them.

Of Blender's, what is beyond is left out; a snapshot with such numbers is refused.
"""

import numpy as np

from . import Instances, Lights, Materials, Mesh, View, World

#: m, and of other numbers, such as matrices and colours. Blender lets users type up to 3e38.
FARTHEST = 1e9

#: W/(sr m²).
BRIGHTEST = 1e15

#: What may scale a mesh.
SMALLEST = 1e-15

#: Of the volume that vectors of their lengths could span, what they do if they are as good as in one plane.
FLAT = 1e-9

#: Of arrays, by the class and its member.
MOST: dict[tuple[type, str], float] = {
    (Mesh, "positions"): FARTHEST,
    (Instances, "world_from_object"): FARTHEST,
    (Materials, "base_color"): FARTHEST,
    (Lights, "position"): FARTHEST,
    (Lights, "axis_u"): FARTHEST,
    (Lights, "axis_v"): FARTHEST,
    (Lights, "radiance"): BRIGHTEST,
    (World, "radiance"): FARTHEST,
    (View, "clip_from_view"): 4.0 * FARTHEST,
    (View, "view_from_world"): 4.0 * FARTHEST,
}


def within(values: np.ndarray, most: float = FARTHEST) -> np.ndarray:
    """Element by element: a number, and none beyond what float32 can deal with."""
    return np.abs(values) <= most


def invertible(linear: np.ndarray) -> np.ndarray:
    """(N,) which of (N,3,3) flatten nothing, as far as float64 tells of Blender's float32."""
    lengths = np.linalg.norm(linear, axis=1)
    return (lengths >= SMALLEST).all(1) & (np.abs(np.linalg.det(linear)) > FLAT * lengths.prod(1))


def spanning(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(N,) whether vectors (N,3) span a plane, in the same way."""
    size = np.linalg.norm(u, axis=1) * np.linalg.norm(v, axis=1)
    return np.linalg.norm(np.cross(u, v), axis=1) > FLAT * size
