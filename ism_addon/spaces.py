# SPDX-License-Identifier: GPL-3.0-or-later
"""Matrices between spaces.

`b_from_a` maps column vectors of space a to space b, in Python and in GLSL. Spaces:
  object   a mesh's own, as Blender stores it
  world    Blender's, float64
  anchor   world, translated by a whole number of grid cells so that the camera is near the origin: the only
           space of positions and directions on the GPU, in float32
  view     the camera's, looking along -z
  clip     OpenGL's
"""

import numpy as np


def anchor_of(camera: np.ndarray, extent: float) -> np.ndarray:
    """Origin (3,) of anchor space, float64 world.

    The camera's position (3,), rounded to a grid whose cells are as large as the scene's extent (m). So the anchor
    rarely changes when the camera moves, and data in anchor space stays valid.
    """
    cell = 2.0 ** np.ceil(np.log2(np.clip(extent, 1e-6, 1e12)))
    return np.round(camera / cell) * cell


def camera_position(view_from_world: np.ndarray) -> np.ndarray:
    """(3,) world: position of the camera of a rigid view (4,4)."""
    return -view_from_world[:3, :3].T @ view_from_world[:3, 3]


def view_from_anchor(view_from_world: np.ndarray, anchor: np.ndarray) -> np.ndarray:
    """(4,4) float64. Positions are subtracted before they are rotated, which avoids cancellation."""
    matrix = view_from_world.copy()
    matrix[:3, 3] = view_from_world[:3, :3] @ (anchor - camera_position(view_from_world))
    return matrix


def orthonormal(normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit tangents (…,3) of unit normals (…,3), without a branch or a pole (Duff et al. 2017)."""
    x, y, z = np.moveaxis(normal, -1, 0)
    sign = np.where(z >= 0.0, 1.0, -1.0)
    a = -1.0 / (sign + z)
    b = x * y * a
    return (
        np.stack([1.0 + sign * x * x * a, sign * b, -sign * x], -1),
        np.stack([b, sign + y * y * a, -y], -1),
    )
