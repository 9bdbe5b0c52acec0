# SPDX-License-Identifier: GPL-3.0-or-later
"""How large a scene's numbers may be, so that float32 still holds their squares after a matrix has moved them.

Of Blender's, what is beyond is left out; a snapshot with such numbers is refused.
"""

import numpy as np

#: m, and of other numbers, such as matrices and colours. Blender lets users type up to 3e38.
MAX_DISTANCE = 1e9

#: W/(sr m²).
MAX_RADIANCE = 1e15

#: What may scale a mesh.
MIN_SCALE = 1e-15

#: Of the volume that vectors of their lengths could span, what they do if they are as good as in one plane.
PLANAR_VOLUME = 1e-9


def is_within(values: np.ndarray, most: float = MAX_DISTANCE) -> np.ndarray:
    """Element by element: a number, and none beyond what float32 can deal with."""
    return np.abs(values) <= most


def is_invertible(linear: np.ndarray) -> np.ndarray:
    """(N,) which of (N,3,3) flatten nothing, as far as float64 tells of Blender's float32."""
    lengths = np.linalg.norm(linear, axis=1)
    return (lengths >= MIN_SCALE).all(1) & (np.abs(np.linalg.det(linear)) > PLANAR_VOLUME * lengths.prod(1))


def spans_plane(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(N,) whether vectors (N,3) span a plane, in the same way."""
    size = np.linalg.norm(u, axis=1) * np.linalg.norm(v, axis=1)
    return np.linalg.norm(np.cross(u, v), axis=1) > PLANAR_VOLUME * size
