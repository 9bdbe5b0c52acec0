# SPDX-License-Identifier: GPL-3.0-or-later
"""Profiles and images of lights, as texels of one table, and where lights find theirs."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from ....scene import LightImage, LightProfile, Lights, LightShape
from ....scene.light_profiles import POLAR_ANGLES
from ...lights.modulation import has_image, has_profile


@dataclass(frozen=True, eq=False)
class LightTextures:
    """Texels as words (T,4) uint32, and the first texel of each profile and image."""

    words: np.ndarray
    profiles: np.ndarray
    images: np.ndarray
    scene_images: Sequence[LightImage]

    @classmethod
    def of(cls, profiles: Sequence[LightProfile], images: Sequence[LightImage]) -> Self:
        """Of all profiles and images of a scene."""
        parts = [*map(profile_words, profiles), *map(image_words, images)]
        starts = np.cumsum([0, *map(len, parts)])[:-1]
        words = np.concatenate([np.zeros((0, 4), np.uint32), *parts])
        return cls(words, starts[: len(profiles)], starts[len(profiles) :], images)

    def refer(self, table: np.ndarray, lights: Lights) -> None:
        """Fill the fields of LIGHT by which the rows (L,) of these lights find their profiles and images."""
        table["profile"] = table["image"] = -1
        profiled, pictured = has_profile(lights), has_image(lights)
        table["profile"][profiled] = self.profiles[lights.profile[profiled]]
        if not pictured.any():
            return
        indices = lights.image[pictured]
        height, width = np.array([image.colors.shape[:2] for image in self.scene_images])[indices].T
        repeats = np.array([image.repeat for image in self.scene_images])[indices]
        u, v, w = image_axes(lights.select(pictured))
        fields = {"image": self.images[indices], "image_width": width, "image_height": height}
        fields |= {"image_repeats": repeats, "image_u": u, "image_v": v, "image_w": w}
        for name, values in fields.items():
            table[name][pictured] = values


def profile_words(profile: LightProfile) -> np.ndarray:
    """(azimuths * texels,4) uint32: see GLSL_CONSTANTS in modulation.py."""
    first = np.arange(0, POLAR_ANGLES - 1, 3)[:, None] + np.arange(4)
    return np.ascontiguousarray(profile.factors[..., first]).view(np.uint32).reshape(-1, 4)


def image_words(image: LightImage) -> np.ndarray:
    """(T,4) uint32: a texel for each colour."""
    return np.pad(image.colors.reshape(-1, 3), ((0, 0), (0, 1))).view(np.uint32)


def image_axes(lights: Lights) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What texture coordinates of areas and spots follow from, (L,3) each: see light_image.glsl."""
    u, v = np.cross(lights.axis_v, lights.normal), np.cross(lights.normal, lights.axis_u)
    u /= np.einsum("lk,lk->l", u, lights.axis_u)[:, None]
    v /= np.einsum("lk,lk->l", v, lights.axis_v)[:, None]
    w, spots = np.zeros_like(u), lights.shape == LightShape.SPOT
    half = 0.5 * lights.spread[spots].astype(np.float64)[:, None]
    scale = 0.5 * np.maximum(np.cos(half), 0.0) / np.maximum(np.sin(half), 1e-6)
    u[spots], v[spots], w[spots] = scale * u[spots], scale * v[spots], lights.normal[spots]
    return u, v, w


NO_TEXTURES = LightTextures.of((), ())
