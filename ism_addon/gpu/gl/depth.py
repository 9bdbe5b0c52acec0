# SPDX-License-Identifier: GPL-3.0-or-later
"""The depth buffer: reversed depth in float32, with the same relative precision at all distances.

Depth is 1 at the near plane and 0 at the far plane: the near plane's distance over that of the surface. Early
depth tests stay possible. Depths close to 0 stay exact only if clip space has depths from 0 to 1 (ARB_clip_control,
OpenGL 4.5). Where it has -1 to 1, as on macOS, the fragment shader writes a logarithm of the distance.
"""

import ctypes

import moderngl
import numpy as np

TEXTURE_2D = 0x0DE1
DEPTH_COMPONENT = 0x1902
DEPTH_COMPONENT32F = 0x8CAC
FLOAT = 0x1406
LOWER_LEFT, ZERO_TO_ONE = 0x8CA1, 0x935F

#: From this ratio of the far plane's distance to the near plane's, the far plane counts as infinite.
INFINITE_FAR = 2.0**40


def use_reversed_depth(gl: moderngl.Context) -> bool:
    """Let the nearer surface pass the depth test. Returns whether clip space has depths from 0 to 1."""
    gl.depth_func = ">"
    return maps_to_zero(gl)


def maps_to_zero(gl: moderngl.Context) -> bool:
    """Let clip space have depths from 0 to 1. Returns whether OpenGL supports it."""
    is_supported = gl.version_code >= 450 or "GL_ARB_clip_control" in gl.extensions
    if is_supported:
        clip_control = ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.c_uint)(gl.mglo._context.load("glClipControl"))
        clip_control(LOWER_LEFT, ZERO_TO_ONE)
    return is_supported


def float_depth(gl: moderngl.Context, size: tuple[int, int]) -> moderngl.Texture:
    """A depth buffer of float32. moderngl allocates 24-bit integers, so the texture is allocated again."""
    texture, load = gl.depth_texture(size), gl.mglo._context.load
    ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.c_uint)(load("glBindTexture"))(TEXTURE_2D, texture.glo)
    image = ctypes.CFUNCTYPE(None, ctypes.c_uint, *[ctypes.c_int] * 5, ctypes.c_uint, ctypes.c_uint, ctypes.c_void_p)
    store = 0, DEPTH_COMPONENT32F, *size, 0
    image(load("glTexImage2D"))(TEXTURE_2D, *store, DEPTH_COMPONENT, FLOAT, None)
    return texture


def planes(clip_from_view: np.ndarray) -> tuple[float, float] | None:
    """Distance of the near plane, and the reciprocal of that of the far plane; None for an orthographic view."""
    (a, b), p = clip_from_view[2, 2:], clip_from_view[3, 2]
    if p == 0.0:
        return None
    near, over_far = p * b / -(a + p), (p - a) / (p * b)
    return near, max(over_far, 1.0 / (INFINITE_FAR * near))


def depth_range(clip_from_view: np.ndarray) -> tuple[float, float]:
    """Distances of the near and of the far plane."""
    near_and_far = planes(clip_from_view)
    if near_and_far is not None:
        return float(near_and_far[0]), float(1.0 / near_and_far[1])
    a, b = clip_from_view[2, 2:]
    return float((b + 1.0) / a), float((b - 1.0) / a)


def nearness(clip_from_view: np.ndarray) -> tuple[float, float]:
    """(x, y) so that x / w + y is 1 at the near plane and 0 at the far one, w being clip space's.

    (0, 0) for an orthographic view, whose depth is linear.
    """
    near_and_far = planes(clip_from_view)
    if near_and_far is None:
        return 0.0, 0.0
    near, over_far = near_and_far
    x = near / (1.0 - near * over_far)
    return float(x), float(-x * over_far)


def logarithm(clip_from_view: np.ndarray) -> tuple[float, float]:
    """(x, y) so that x + y log2(w) is 1 at the near plane and 0 at the far one; (0, 0) for an orthographic view."""
    near_and_far = planes(clip_from_view)
    if near_and_far is None:
        return 0.0, 0.0
    nearest, farthest = np.log2(near_and_far[0]), -np.log2(near_and_far[1])
    return float(farthest / (farthest - nearest)), float(-1.0 / (farthest - nearest))
