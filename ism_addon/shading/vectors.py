# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations of the nodes Vector Math, Map Range and Mix of vectors, Mapping and Vector Rotate, as in Cycles."""

from collections.abc import Callable
from operator import itemgetter

import numpy as np

from . import arithmetic
from .operations import OPERATIONS, register, set_cost


def by_component(function: Callable[..., float]) -> Callable[..., np.ndarray]:
    """The function of numbers for each component of vectors (3,)."""
    return lambda *vectors: np.array([function(*numbers) for numbers in zip(*vectors, strict=True)])


def of_numbers(name: str) -> Callable[..., np.ndarray]:
    """The reference of an operation of numbers, for each component."""
    reference = OPERATIONS[name].reference
    assert reference is not None
    return by_component(reference)


divide = by_component(arithmetic.divide)


def normalized(a: np.ndarray) -> np.ndarray:
    """Of length 1; zero if it has none."""
    length = np.linalg.norm(a)
    return a / length if length else np.zeros(3)


def project(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The part of a along b."""
    square = b @ b
    return a @ b / square * b if square else np.zeros(3)


def reflect(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """A mirrored at the plane perpendicular to b."""
    n = normalized(b)
    return a - 2.0 * (a @ n) * n


def refract(a: np.ndarray, b: np.ndarray, ior: float) -> np.ndarray:
    """A refracted at that plane; zero if all of it is reflected."""
    n = normalized(b)
    cosine = a @ n
    square = 1.0 - ior * ior * (1.0 - cosine * cosine)
    return ior * a - (ior * cosine + np.sqrt(square)) * n if square >= 0.0 else np.zeros(3)


def euler_matrix(angles: np.ndarray) -> np.ndarray:
    """(3,3): rotation by Euler angles in the order XYZ, radians."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(angles), np.sin(angles)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]])
    about_y = np.array([[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]])
    about_z = np.array([[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]])
    result: np.ndarray = about_z @ about_y @ about_x
    return result


def about_axis(vector: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """A vector rotated about an axis of any length (Rodrigues)."""
    n = normalized(axis)
    if not n.any():
        return vector
    cosine, sine = np.cos(angle), np.sin(angle)
    return vector * cosine + np.cross(n, vector) * sine + n * (n @ vector) * (1.0 - cosine)


register(
    "vectors",
    "vec3 vec3",
    "vec3",
    **{
        f"vector_{name}": of_numbers(f"math_{name}")
        for name in ("add", "subtract", "multiply", "divide", "minimum", "maximum", "modulo", "snap", "power")
    },
    vector_cross_product=np.cross,
    vector_project=project,
    vector_reflect=reflect,
)
register(
    "vectors",
    "vec3",
    "vec3",
    **{
        f"vector_{name}": of_numbers(f"math_{name}")
        for name in ("absolute", "floor", "ceil", "sine", "cosine", "tangent", "sign")
    },
    vector_fraction=of_numbers("math_fract"),
    vector_normalize=normalized,
    vector_saturate=of_numbers("saturate"),
)
register(
    "vectors",
    "vec3 vec3 vec3",
    "vec3",
    vector_multiply_add=lambda a, b, c: a * b + c,
    vector_wrap=of_numbers("math_wrap"),
    vector_faceforward=lambda a, b, c: a if b @ c < 0.0 else -a,
    vector_fraction_linear=of_numbers("fraction_linear"),
    vector_fraction_smoothstep=of_numbers("fraction_smoothstep"),
    vector_fraction_smootherstep=of_numbers("fraction_smootherstep"),
    vector_clamp_range=of_numbers("clamp_range"),
    mix_by_component=of_numbers("mix_float"),
    rotate_euler=lambda v, centre, angles: euler_matrix(angles) @ (v - centre) + centre,
    rotate_euler_inverse=lambda v, centre, angles: euler_matrix(angles).T @ (v - centre) + centre,
)
register(
    "vectors",
    "vec3 vec3 vec3 vec3",
    "vec3",
    vector_fraction_stepped=of_numbers("fraction_stepped"),
    mapping_point=lambda v, location, rotation, scale: euler_matrix(rotation) @ (v * scale) + location,
    mapping_texture=lambda v, location, rotation, scale: divide(euler_matrix(rotation).T @ (v - location), scale),
    mapping_vector=lambda v, location, rotation, scale: euler_matrix(rotation) @ (v * scale),
    mapping_normal=lambda v, location, rotation, scale: normalized(euler_matrix(rotation) @ divide(v, scale)),
)
register("vectors", "vec3 vec3", "float", vector_dot_product=np.dot, vector_distance=lambda a, b: np.linalg.norm(a - b))
register("vectors", "vec3", "float", vector_length=np.linalg.norm)
register("vectors", "float float float", "vec3", combine_xyz=lambda x, y, z: np.array([x, y, z]))
register("vectors", "vec3", "float", **{f"separate_{'xyz'[k]}": itemgetter(k) for k in range(3)})
register("vectors", "vec3 float", "vec3", vector_scale=lambda a, scale: a * scale)
register("vectors", "float vec3 vec3", "vec3", mix_vector=lambda t, a, b: a * (1.0 - t) + b * t)
register("vectors", "vec3 vec3 float", "vec3", vector_refract=refract)
register(
    "vectors",
    "vec3 vec3 vec3 float",
    "vec3",
    rotate_axis=lambda v, centre, axis, angle: about_axis(v - centre, axis, angle) + centre,
)
set_cost(8, "vector_power")
