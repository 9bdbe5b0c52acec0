# SPDX-License-Identifier: GPL-3.0-or-later
"""A night market: stalls with awnings, crates and fruit, lit by twenty small area lights of many sizes and spreads."""

import math
from pathlib import Path

import numpy as np
from mathutils import Matrix

from tests.scenes.parts.architecture import urn
from tests.scenes.parts.shapes import Shape, box, grid, join
from tests.scenes.parts.solids import ball, tube

from . import blend_file
from .atrium import SceneBuilder
from .blend_file import COOL, WARM, WHITE, AreaLight, Point

STALLS = ((-2.1, 1.2, 0.25), (0.3, 2.0, -0.1), (2.5, 1.1, -0.4))  # x and y in m, rotation in rad
SHAPES = ("SQUARE", "DISK", "RECTANGLE", "ELLIPSE")
CAMERAS = (((0.3, -2.9, 1.6), (0.1, 1.0, 0.8), 27.0), ((-1.7, -3.2, 1.9), (0.3, 1.1, 0.8), 26.0))
COUNT = 20


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    builder, random = SceneBuilder(), np.random.default_rng(500 + variant)
    add_market(builder, random)
    blend_file.add_lights(market_lights(random))
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)


def add_market(builder: SceneBuilder, random: np.random.Generator) -> None:
    """The street with a house, stalls and crates."""
    builder.add("Street", [(box((-7.0, -6.0, -0.2), (7.0, 6.0, 0.0)), "Concrete")])
    builder.add("House", [(box((-7.0, 3.6, 0.0), (7.0, 4.0, 5.0)), "Paper")])
    goods = {
        "Fruit": ball(1.0, 10),
        "Loaf": ball(1.0, 8, 3.0),
        "Jar": urn(2.0).moved(z=-1.0),
    }
    for index, (x, y, angle) in enumerate(STALLS):
        matrix = Matrix.Translation((x, y, 0.0)) @ Matrix.Rotation(angle, 4, "Z")
        builder.add("Stall", [(stall(), "Bark")], [matrix])
        color = ("Clay", "Teal", "Plum")[index]
        builder.add(f"Awning, {color}", [(awning(), color)], [matrix])
        add_goods(builder, goods, matrix, random)
    for _ in range(9):
        x, y = random.uniform((-2.6, -1.7), (2.6, 0.4))
        size = random.uniform(0.6, 1.3)
        matrix = Matrix.Translation((x, y, 0.0)) @ Matrix.Rotation(random.uniform(0.0, 3.0), 4, "Z")
        builder.add("Crate", [(crate(), "Ochre")], [matrix @ Matrix.Scale(size, 4)])


def market_lights(random: np.random.Generator) -> list[AreaLight]:
    """Two lights under each awning, the others above the street: 3 to 40 cm wide, spread 40° to 180°."""
    positions: list[Point] = []
    for x, y, angle in STALLS:
        for along in (-0.45, 0.5):
            positions.append((x + along * math.cos(angle), y - 0.15 + along * math.sin(angle), 1.72))
    while len(positions) < COUNT:
        x, y = random.uniform((-3.6, -2.4), (3.6, 2.6))
        positions.append((float(x), float(y), float(random.uniform(2.4, 3.3))))
    lights = []
    for index, (x, y, z) in enumerate(positions):
        size = 0.03 * (0.4 / 0.03) ** random.random()
        offset = random.uniform(-0.5, 0.5, 2)
        spread = (180.0, 180.0, 120.0, 70.0, 40.0)[index % 5]
        watts = (9.0 if z < 2.0 else 20.0) * (0.45 if spread < 90.0 else 1.0)
        color = (WARM, WARM, WHITE, COOL)[index % 4]
        position, target = (x, y, z), (x + offset[0], y + offset[1], 0.0)
        lights.append(AreaLight(SHAPES[index % 4], position, target, watts, (size, 0.5 * size), color, spread))
    return lights


def stall() -> Shape:
    """A table on legs, and four poles."""
    parts = [box((-0.9, -0.4, 0.78), (0.9, 0.4, 0.82))]
    for x in (-0.85, 0.85):
        for y in (-0.36, 0.36):
            parts.append(box((x - 0.03, y - 0.03, 0.0), (x + 0.03, y + 0.03, 0.79)))
            pole = np.array([(x, 1.2 * y, 0.0), (x, 1.2 * y, 1.0), (x, 1.2 * y, 2.0 if y > 0.0 else 1.8)])
            parts.append(tube(pole, 0.014, 8))
    return join(parts)


def awning() -> Shape:
    """A cloth with a scalloped edge above a stall."""
    u, v = np.meshgrid(np.linspace(-1.0, 1.0, 61), np.linspace(-1.0, 1.0, 25), indexing="ij")
    hem = np.clip((-v - 0.72) / 0.28, 0.0, 1.0)
    z = 1.9 + 0.1 * v + 0.015 * np.cos(10.0 * np.pi * u) - hem**2 * (0.16 + 0.06 * np.abs(np.cos(5.0 * np.pi * u)))
    return grid(np.stack([u, 0.62 * v, z], axis=-1), np.stack([u, v], axis=-1))


def crate() -> Shape:
    """A box of slats, open at the top."""
    parts = [box((-0.2, -0.15, 0.0), (0.2, 0.15, 0.015))]
    for z in (0.02, 0.09, 0.16):
        parts += [box((-0.2, y - 0.006, z), (0.2, y + 0.006, z + 0.05)) for y in (-0.144, 0.144)]
        parts += [box((x - 0.006, -0.138, z), (x + 0.006, 0.138, z + 0.05)) for x in (-0.194, 0.194)]
    return join(parts)


def add_goods(builder: SceneBuilder, goods: dict[str, Shape], table: Matrix, random: np.random.Generator) -> None:
    """Goods in rows on a stall's table."""
    for column in range(9):
        name = list(goods)[random.integers(len(goods))]
        color = ("Clay", "Ochre", "Leaf", "Plum", "Terracotta")[random.integers(5)]
        for row in range(5):
            radius = random.uniform(0.055, 0.085)
            x, y = -0.76 + 0.19 * column + random.uniform(-0.02, 0.02), -0.32 + 0.155 * row
            matrix = table @ Matrix.Translation((x, y, 0.82 + (0.8 if name == "Loaf" else 1.0) * radius))
            flat = Matrix.Diagonal((1.0, 1.0, 0.8 if name == "Loaf" else 1.0, 1.0))
            rotation = Matrix.Rotation(random.uniform(0.0, 6.3), 4, "Z")
            builder.add(
                f"{name}, {color}", [(goods[name], color)], [matrix @ rotation @ flat @ Matrix.Scale(radius, 4)]
            )
