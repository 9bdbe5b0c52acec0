# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of the scene tree: leaves cut out by their image's alpha, bark, grass, brick paving, weathered wood."""

from collections.abc import Callable

import bpy
import numpy as np

from tests.scenes.parts.textures import mix, noise, pixels

from .graph import Graph, plain


def leaf_image(size: int = 256) -> np.ndarray:
    """A serrated leaf with veins, its stalk at the lower edge: (H,W,4) sRGB with alpha."""
    x, y = pixels(size)
    across, along = 2.0 * x - 1.0, (y - 0.12) / 0.86
    inside = np.clip(along, 0.0, 1.0)
    half = 0.95 * np.sin(np.pi * inside**0.8) ** 0.9 * (1.0 - 0.25 * inside)
    half -= 0.05 * ((inside * 18.0) % 1.0) * (half > 0.1)
    is_leaf = (np.abs(across) < half) & (along > 0.0) & (along < 1.0)
    is_stalk = (np.abs(across) < 0.03) & (along <= 0.05)
    side_vein = (along * 7.0 - 2.2 * np.abs(across)) % 1.0
    vein = np.maximum(np.abs(across) < 0.03, np.abs(side_vein - 0.5) < 0.05 + 0.03 * noise(size, 1.0, 5))
    color = mix((0.33, 0.48, 0.14), (0.48, 0.62, 0.22), 0.5 + 0.3 * noise(size, 1.5, 6))
    color = mix(color, (0.60, 0.68, 0.36), 0.7 * vein)
    return np.concatenate([np.clip(color, 0.0, 1.0), (is_leaf | is_stalk)[..., None]], axis=-1)


def leaf(name: str) -> bpy.types.Material:
    """Cards that show a leaf of 0..1 in both coordinates, in a different green on each twig."""
    graph = Graph(name)
    image = graph.image(leaf_image(), graph.coordinates())
    random = graph.add("ObjectInfo", {}).outputs["Random"]
    tint = graph.ramp(random, (0.0, (0.72, 0.85, 0.5)), (0.6, (1.0, 1.0, 1.0)), (1.0, (1.35, 1.05, 0.5)))
    base = graph.mix(1.0, image.outputs["Color"], tint, "MULTIPLY")
    return graph.surface(base, 0.4, alpha=image.outputs["Alpha"])


def bark(name: str) -> bpy.types.Material:
    """Furrowed bark: an image with a bump, mossy in places."""
    size = 512
    x, y = pixels(size)
    warp = noise(size, 1.4, 11)
    furrows = np.abs(np.sin(2.0 * np.pi * (6.0 * x + 0.22 * warp)))
    cracks = 0.75 + 0.25 * np.sin(2.0 * np.pi * (5.0 * y + 0.5 * warp))
    height = np.clip(furrows * cracks + 0.08 * noise(size, 0.8, 12), 0.0, 1.0)
    color = mix((0.17, 0.13, 0.10), (0.50, 0.43, 0.36), height)
    graph = Graph(name)
    image = graph.image(color, graph.coordinates(1.4))
    damp = graph.noise(graph.coordinates(3.0, "Object"), 1.0)
    moss = graph.mask(damp, 0.5, 0.8)
    base = graph.mix(moss, image, (0.10, 0.13, 0.04))
    return graph.surface(base, 0.8, normal=graph.bump(image, 0.02))


def grass(name: str) -> bpy.types.Material:
    """A lawn from above: blades in an image, and paler patches."""
    size = 1024
    blades = np.zeros((size, size))
    random = np.random.default_rng(13)
    t = np.linspace(0.0, 1.0, 40)[:, None]
    foot, lean = random.random((2, 1, 24_000)), random.normal(0.0, 0.016, (2, 1, 24_000))
    shade = random.random(24_000) * (0.35 + 0.65 * t)
    column, row = ((foot + lean * t) * size).astype(int) % size
    np.maximum.at(blades, (row.ravel(), column.ravel()), shade.ravel())
    color = mix((0.17, 0.22, 0.07), (0.56, 0.66, 0.27), blades)
    graph = Graph(name)
    image = graph.image(color, graph.coordinates(0.5))
    dry = graph.mask(graph.noise(graph.coordinates(), 0.9, 6.0, 0.65), 0.45, 0.7)
    base = graph.mix(dry, image, graph.mix(1.0, image, (1.6, 1.25, 0.8), "MULTIPLY"))
    return graph.surface(base, 0.75, normal=graph.bump(image, 0.01))


def brick_paving(name: str) -> bpy.types.Material:
    """Bricks of 20 × 10 cm with sandy joints."""
    graph = Graph(name)
    at = graph.coordinates()
    grain = graph.noise(at, 30.0, 4.0)
    red, brown = (graph.mix(grain, dark, light) for dark, light in (
        ((0.22, 0.075, 0.045), (0.40, 0.16, 0.10)), ((0.16, 0.09, 0.065), (0.30, 0.19, 0.14)),
    ))  # fmt: skip
    bricks = graph.add(
        "TexBrick",
        {
            "Vector": at, "Color1": red, "Color2": brown, "Mortar": (0.35, 0.30, 0.22), "Scale": 1.0,
            "Mortar Size": 0.006, "Mortar Smooth": 0.3, "Brick Width": 0.2, "Row Height": 0.1,
        },
    )  # fmt: skip
    return graph.surface(bricks, 0.7, normal=graph.bump(bricks.outputs["Fac"], -0.006))


def weathered_wood(name: str) -> bpy.types.Material:
    """Grey-brown planks: a stretched wave texture."""
    graph = Graph(name)
    at = graph.coordinates((1.2, 14.0, 14.0), "Object")
    grain = graph.add("TexWave", {"Vector": at, "Scale": 0.7, "Distortion": 6.0, "Detail": 3.0}, bands_direction="Y")
    base = graph.ramp(grain, (0.0, (0.14, 0.09, 0.055)), (0.6, (0.34, 0.24, 0.16)), (1.0, (0.42, 0.33, 0.25)))
    return graph.surface(base, graph.range(grain, 0.45, 0.7), normal=graph.bump(grain, 0.002))


def painted_wood(name: str) -> bpy.types.Material:
    """White paint that has flaked off here and there."""
    graph = Graph(name)
    flakes = graph.noise(graph.coordinates((9.0, 9.0, 3.0), "Object"), 1.0, 5.0, 0.65)
    mask = graph.mask(flakes, 0.60, 0.63)
    base = graph.mix(mask, (0.72, 0.71, 0.67), (0.26, 0.19, 0.13))
    return graph.surface(base, graph.range(mask, 0.3, 0.75), normal=graph.bump(mask, -0.002))


#: By name; each is made at its first use.
MATERIALS: dict[str, Callable[[str], bpy.types.Material]] = {
    "Leaf card": leaf,
    "Furrowed bark": bark,
    "Lawn": grass,
    "Brick paving": brick_paving,
    "Weathered wood": weathered_wood,
    "Painted wood": painted_wood,
    "Cast iron": lambda name: plain(name, (0.05, 0.055, 0.06), 0.35, metallic=1.0),
}
