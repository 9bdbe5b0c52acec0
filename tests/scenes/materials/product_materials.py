# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of the products: metals, plastics, lacquer, leather, glaze, and printed labels."""

from collections.abc import Callable

import bpy
import numpy as np

from tests.scenes.parts.textures import mix, noise, pixels

from .graph import Color, Graph, plain

INK, CREAM, GILT = (0.12, 0.10, 0.09), (0.93, 0.89, 0.78), (0.62, 0.45, 0.16)  # sRGB, of labels


def backdrop(name: str) -> bpy.types.Material:
    """Paper with a faint grain."""
    graph = Graph(name)
    grain = graph.noise(graph.coordinates(source="Object"), 12.0)
    return graph.surface(graph.ramp(grain, (0.3, (0.21, 0.22, 0.24)), (0.7, (0.23, 0.24, 0.26))), 0.5)


def brushed(name: str) -> bpy.types.Material:
    """Aluminium brushed around the axis: scratches of different roughness and height."""
    graph = Graph(name)
    scratches = graph.noise(graph.coordinates((2.0, 900.0, 1.0)), 1.0, 4.0)
    base = graph.ramp(scratches, (0.25, (0.62, 0.63, 0.65)), (0.75, (0.78, 0.79, 0.80)))
    roughness, normal = graph.range(scratches, 0.2, 0.4), graph.bump(scratches, 0.0002)
    return graph.surface(base, roughness, metallic=1.0, normal=normal)


def label(name: str) -> bpy.types.Material:
    """The bottle's paper label: a medallion, a double border and lines of print. It goes around twice."""
    size = 512
    x, y = pixels(size)
    rim = np.minimum(np.minimum(x, 1.0 - x), np.minimum(y, 1.0 - y))
    radius, angle = np.hypot(x - 0.5, y - 0.66), np.arctan2(y - 0.66, x - 0.5)
    star = radius < 0.11 + 0.035 * np.cos(8.0 * angle)
    medallion = ((radius < 0.2) & (radius > 0.18)) | star
    words = np.random.default_rng(3).random((8, 64)) > 0.3
    row, column = (y * 20.0).astype(int), (x * 64.0).astype(int)
    is_print = (row < 8) & (row > 1) & (y * 20.0 % 1.0 > 0.5) & (np.abs(x - 0.5) < 0.36 - 0.03 * (row % 3))
    lines = is_print & words[np.clip(row, 0, 7), column]
    color = mix(CREAM, INK, lines.astype(float))
    border = ((rim > 0.03) & (rim < 0.045)) | ((rim > 0.055) & (rim < 0.06))
    color = mix(color, GILT, (medallion | border).astype(float))
    graph = Graph(name)
    return graph.surface(graph.image(color, graph.coordinates((1.0 / (0.041 * np.pi), 8.0, 1.0))), 0.5)


def dial_image(ground: Color, ink: Color, size: int = 512) -> np.ndarray:
    """A dial with marks of hours and minutes, and three hands."""
    x, y = (2.0 * each - 1.0 for each in pixels(size))
    radius, turn = np.hypot(x, y), np.arctan2(x, y) / (2.0 * np.pi)
    marks = np.zeros_like(x, bool)
    for count, width, start in ((60, 0.004, 0.74), (12, 0.016, 0.66)):
        off = np.abs((turn * count + 0.5) % 1.0 - 0.5) / count * 2.0 * np.pi * radius
        marks |= (off < width) & (radius > start) & (radius < 0.8)
    for hour, length, width in ((10.15, 0.38, 0.03), (1.8, 0.62, 0.02), (6.7, 0.68, 0.007)):
        direction = np.array([np.sin(np.pi * hour / 6.0), np.cos(np.pi * hour / 6.0)])
        along, off = x * direction[0] + y * direction[1], np.abs(x * direction[1] - y * direction[0])
        marks |= (along > -0.1) & (along < length) & (off < width)
    return mix(ground, ink, marks.astype(float))


def dial(name: str) -> bpy.types.Material:
    """A watch's dial in 4 × 4 cm, under a clear coat."""
    graph = Graph(name)
    image = graph.image(dial_image((0.05, 0.09, 0.19), (0.95, 0.95, 0.92)), graph.coordinates(25.0))
    return graph.surface(image, 0.3, coat_weight=1.0, coat_roughness=0.05)


def leatherette(name: str) -> bpy.types.Material:
    """Black grained plastic around a camera."""
    graph = Graph(name)
    cells = graph.add("TexVoronoi", {"Vector": graph.coordinates(), "Scale": 900.0})
    return graph.surface((0.02, 0.02, 0.022), 0.42, normal=graph.bump(cells.outputs["Distance"], 0.0006))


def stoneware(name: str) -> bpy.types.Material:
    """Unglazed clay with dark specks and the ridges of the wheel."""
    graph = Graph(name)
    at = graph.coordinates(source="Object")
    clay = graph.ramp(graph.noise(at, 60.0), (0.3, (0.42, 0.34, 0.26)), (0.7, (0.58, 0.49, 0.39)))
    specks = graph.mask(graph.noise(at, 420.0, 1.0), 0.62, 0.68)
    ridges = graph.noise(graph.coordinates((3.0, 3.0, 260.0), source="Object"), 1.0, 2.0)
    return graph.surface(graph.mix(specks, clay, (0.10, 0.07, 0.05)), 0.5, normal=graph.bump(ridges, 0.003))


def lacquer(name: str) -> bpy.types.Material:
    """Red lacquer with gold dust under a clear coat."""
    graph = Graph(name)
    dust = graph.mask(graph.noise(graph.coordinates(), 300.0, 2.0), 0.60, 0.64)
    base = graph.mix(dust, (0.33, 0.012, 0.01), (0.75, 0.45, 0.12))
    return graph.surface(base, 0.4, metallic=dust, coat_weight=1.0, coat_roughness=0.04)


def porcelain(name: str) -> bpy.types.Material:
    """White glaze with a blue pattern of vines in bands around the vase."""
    size = 512
    x, y = pixels(size)
    vine = np.abs(y - 0.5 - 0.16 * np.sin(2.0 * np.pi * 3.0 * x)) < 0.012
    leaves = np.hypot((x * 6.0) % 1.0 - 0.5, (y - 0.5 + 0.17 * np.sin(2.0 * np.pi * 3.0 * x)) * 5.0) < 0.3
    end = np.minimum(y, 1.0 - y)
    bands = (np.abs(end - 0.12) < 0.02) | (np.abs(end - 0.17) < 0.006)
    tone = 0.8 + 0.1 * noise(size, 1.5, 7)
    color = mix((0.93, 0.94, 0.95), (0.08, 0.17, 0.50), (vine | leaves | bands) * tone)
    graph = Graph(name)
    scale = 3.0 / (2.0 * np.pi * 0.058), 1.0 / 0.25, 1.0
    return graph.surface(graph.image(color, graph.coordinates(scale)), 0.12)


#: By name; each is made at its first use.
MATERIALS: dict[str, Callable[[str], bpy.types.Material]] = {
    "Seamless paper": backdrop,
    "Brushed aluminium": brushed,
    "Label": label,
    "Dial": dial,
    "Leatherette": leatherette,
    "Stoneware": stoneware,
    "Lacquer": lacquer,
    "Porcelain": porcelain,
    "Steel": lambda name: plain(name, (0.66, 0.67, 0.69), 0.14, metallic=1.0),
    "Satin steel": lambda name: plain(name, (0.60, 0.61, 0.62), 0.3, metallic=1.0),
    "Gold": lambda name: plain(name, (0.92, 0.66, 0.28), 0.08, metallic=1.0),
    "Rose gold": lambda name: plain(name, (0.90, 0.54, 0.42), 0.2, metallic=1.0),
    "Foil": lambda name: plain(name, (0.60, 0.42, 0.16), 0.25, metallic=1.0),
    "Chrome": lambda name: plain(name, (0.80, 0.81, 0.83), 0.05, metallic=1.0),
    "Bottle glass": lambda name: plain(name, (0.006, 0.022, 0.010), 0.1),
    "Lens glass": lambda name: plain(name, (0.012, 0.010, 0.03), 0.1, coat_weight=1.0, coat_roughness=0.03),
    "Black plastic": lambda name: plain(name, (0.025, 0.025, 0.027), 0.3),
    "Yellow plastic": lambda name: plain(name, (0.85, 0.52, 0.03), 0.18),
    "Orange plastic": lambda name: plain(name, (0.78, 0.17, 0.02), 0.22),
    "Red enamel": lambda name: plain(name, (0.6, 0.02, 0.02), 0.15),
}
