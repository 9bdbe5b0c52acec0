# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps of all directions by formulas: a clear sky with the sun above a town, and an overcast sky above trees."""

from collections.abc import Sequence

import bpy
import numpy as np

from ism_addon.gpu.environment.equirectangular import directions_at
from tests.scenes.parts.node_tree import world_of
from tests.scenes.parts.textures import noise

WIDTH, HEIGHT = 1024, 512
#: Of the sun: half of its angle, rad, as in photographs, which blur it; and the fraction of all light that it gives.
SUN_RADIUS, SUN_FRACTION = 0.006, 0.45

Radiance = np.ndarray  # (HEIGHT,WIDTH,3) float32, bottom row first


def directions() -> np.ndarray:
    """(HEIGHT,WIDTH,3) unit vectors of the texels of Blender's Environment Texture."""
    return directions_at(np.arange(HEIGHT), np.arange(WIDTH), HEIGHT, WIDTH)


def skyline(seed: int, lowest: float, highest: float, parts: int) -> np.ndarray:
    """(WIDTH,) heights, as the tangent of the angle above the horizon, of houses or trees all around."""
    random = np.random.default_rng(seed)
    heights = random.uniform(lowest, highest, parts)
    return heights[np.arange(WIDTH) * parts // WIDTH]


def clear(seed: int, sun: Sequence[float]) -> Radiance:
    """A blue sky, brighter near the horizon and the sun (a vector to it), above houses and pale ground."""
    d, to_sun = directions(), np.array(sun) / np.linalg.norm(sun)
    up, cosine = d[..., 2:], (d @ to_sun)[..., None]
    sky = np.array([0.25, 0.45, 0.95]) + np.exp(-6.0 * np.maximum(up, 0.0)) * np.array([0.65, 0.6, 0.35])
    clouds = np.clip(np.tile(noise(HEIGHT, 1.6, seed), (1, 2)) - 0.45, 0.0, None)[..., None]
    sky = sky + 2.5 * clouds * np.clip(3.0 * up, 0.0, 1.0)
    sky += np.array([1.0, 0.9, 0.7]) * (2.0 * np.exp(8.0 * (cosine - 1.0)) + 12.0 * np.exp(300.0 * (cosine - 1.0)))
    tangent = up[..., 0] / np.maximum(np.hypot(d[..., 0], d[..., 1]), 1e-6)
    houses = (tangent < skyline(seed, 0.02, 0.35, 24)) & (tangent >= 0.0)
    facing = 0.12 + 0.35 * np.clip(-(d[..., :2] @ to_sun[:2]), 0.0, None)
    sky = np.where(houses[..., None], facing[..., None] * np.array([0.9, 0.8, 0.7]), sky)
    radiance = np.where(up < 0.0, np.array([0.34, 0.31, 0.27]), sky)
    disc = np.arccos(np.clip(cosine, -1.0, 1.0)) < SUN_RADIUS
    weight = np.sqrt(np.maximum(1.0 - up * up, 0.0))
    level = SUN_FRACTION / (1.0 - SUN_FRACTION) * (radiance * weight).sum() / (3.0 * (disc * weight).sum())
    return (radiance + disc * level * np.array([1.08, 1.0, 0.86])).astype(np.float32)


def overcast(seed: int) -> Radiance:
    """Three times as bright at the zenith as at the horizon (Moon & Spencer 1942), above trees and dark ground."""
    d = directions()
    up = d[..., 2:]
    sky = (1.0 + 2.0 * np.maximum(up, 0.0)) / 3.0 * np.array([0.92, 0.97, 1.05])
    tangent = up[..., 0] / np.maximum(np.hypot(d[..., 0], d[..., 1]), 1e-6)
    trees = (tangent < skyline(seed, 0.05, 0.3, 120)) & (tangent >= 0.0)
    sky = np.where(trees[..., None], np.array([0.05, 0.08, 0.03]), sky)
    return np.where(up < 0.0, np.array([0.12, 0.14, 0.07]), sky).astype(np.float32)


def world_with(radiance: Radiance, strength: float = 1.0) -> bpy.types.World:
    """A world of a map, which is kept in the file."""
    texels = np.ones((HEIGHT, WIDTH, 4), np.float32)
    texels[..., :3] = radiance
    image = bpy.data.images.new("Map", WIDTH, HEIGHT, float_buffer=True)
    image.pixels.foreach_set(texels.ravel())
    image.pack()

    def shader(tree):
        texture = tree.add("ShaderNodeTexEnvironment", image=image)
        return tree.add("ShaderNodeBackground", {"Color": texture, "Strength": strength})

    return world_of(shader)
