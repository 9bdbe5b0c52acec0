# SPDX-License-Identifier: GPL-3.0-or-later
"""A million triangles in few meshes: a canyon of eroded rock, with boulders in it."""

from pathlib import Path

import bpy
import numpy as np

from tests.scenes.parts.shapes import Shape
from tests.scenes.parts.solids import ball

from . import blend_file
from .atrium import SceneBuilder
from .blend_file import COOL, WARM, AreaLight, large_mesh

SIDE, HALF_WIDTH = 620, 6.0  # quads along the ground's side, and half of the side in m
BOULDER = 72  # quads along a boulder's side

LIGHTS = (
    (
        AreaLight("DISK", (-5.0, -1.5, 4.6), (0.2, 0.5, 0.3), 260.0, (0.8, 0.8), WARM),
        AreaLight("RECTANGLE", (4.6, 3.2, 4.0), (0.0, 0.6, 0.2), 231.0, (2.4, 0.8), COOL),
        AreaLight("SQUARE", (0.5, 1.6, 5.5), (0.3, 0.9, 0.0), 165.0, (2.2, 2.2)),
        AreaLight("ELLIPSE", (2.3, -1.6, 1.7), (1.0, 0.8, 0.3), 23.0, (0.3, 0.15), WARM, 100.0),
    ),
    (
        AreaLight("SQUARE", (4.6, -2.2, 4.2), (0.0, 0.6, 0.3), 280.0, (0.7, 0.7), WARM),
        AreaLight("ELLIPSE", (-4.4, 3.4, 3.6), (0.0, 0.6, 0.2), 231.0, (2.0, 1.0), COOL),
        AreaLight("RECTANGLE", (-0.5, 0.8, 5.2), (-0.3, 0.9, 0.0), 148.0, (3.0, 1.4)),
        AreaLight("DISK", (-2.1, -1.4, 1.6), (-1.0, 0.9, 0.3), 20.0, (0.25, 0.25), WARM),
    ),
)
CAMERAS = (((0.5, -3.9, 2.1), (0.1, 0.6, 0.45), 34.0), ((-1.2, -3.8, 2.0), (-0.1, 0.8, 0.45), 34.0))


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    random = np.random.default_rng(300 + variant)
    materials = SceneBuilder().materials
    line = np.linspace(-HALF_WIDTH, HALF_WIDTH, SIDE + 1)
    x, y = np.meshgrid(line, line, indexing="ij")
    bed = rocks(np.stack([x, y, np.zeros_like(x)], axis=-1), random)
    index = np.arange(x.size).reshape(x.shape)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    add_object("Canyon", large_mesh("Canyon", bed.reshape(-1, 3), quads, materials["Sandstone"]))
    for index, (position, radius) in enumerate(boulders(random)):
        column, row = (np.array(position) + HALF_WIDTH) / (2.0 * HALF_WIDTH) * SIDE
        height = bed[int(column), int(row), 2] + 0.55 * radius
        shape = boulder(radius, random)
        color = ("Concrete", "Clay", "Marble")[index % 3]
        solid = large_mesh(f"Boulder {index + 1}", shape.positions + (*position, height), shape.quads, materials[color])
        add_object(solid.name, solid)
    blend_file.add_lights(LIGHTS[variant])
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)


def add_object(name: str, mesh: bpy.types.Mesh) -> None:
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def rocks(plane: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Ground (N,N,3) with ridges that rise to the sides, terraces, and fine bumps."""
    x, y = plane[..., 0], plane[..., 1]
    shift = np.stack([x, y, np.zeros_like(x)], axis=-1)
    broad = ridges(shift, random, (0.35, 0.8, 1.7))
    valley = np.clip((np.abs(x + 0.6 * np.sin(0.7 * y)) - 1.0) / 3.0, 0.0, 1.0) ** 1.3
    height = valley * (1.1 + 1.8 * broad) + 0.4 * ridges(shift, random, (1.5, 3.1, 5.7))
    steps = 5.0 * height
    height = 0.7 * height + 0.3 * (np.floor(steps) + np.clip((steps % 1.0 - 0.3) / 0.4, 0.0, 1.0)) / 5.0
    height += 0.09 * ridges(shift, random, (6.0, 13.0)) + 0.02 * ridges(shift, random, (19.0, 31.0))
    return np.stack([x, y, height], axis=-1)


def ridges(points: np.ndarray, random: np.random.Generator, frequencies: tuple[float, ...]) -> np.ndarray:
    """Sharp-crested waves over points (…,3), finer ones weaker; about 0..1."""
    total = np.zeros(points.shape[:-1])
    for frequency in frequencies:
        for _ in range(3):
            direction = random.normal(size=3)
            phase = points @ (direction * frequency / np.linalg.norm(direction) * 2.0) + random.uniform(0.0, 6.3)
            bend = 0.8 * np.sin(0.6 * phase + points[..., 0] * frequency + random.uniform(0.0, 6.3))
            total += (1.0 - np.abs(np.sin(phase + bend))) * frequencies[0] / frequency / 3.0
    return total / sum(frequencies[0] / frequency for frequency in frequencies)


def boulder(radius: float, random: np.random.Generator) -> Shape:
    """A rounded block, displaced by ridges of three sizes."""
    sphere = ball(1.0, BOULDER, 2.6)
    scale = 1.0 + 0.35 * (ridges(sphere.positions, random, (1.2, 2.6)) - 0.5)
    scale += 0.07 * ridges(sphere.positions, random, (7.0, 15.0)) + 0.012 * ridges(sphere.positions, random, (31.0,))
    return Shape(radius * sphere.positions * scale[:, None] * (1.0, 1.0, 0.85), sphere.quads, sphere.uvs)


def boulders(random: np.random.Generator) -> list[tuple[tuple[float, float], float]]:
    """Positions (x, y) and radii of eight boulders in the valley, all in m."""
    placed = []
    for radius in (0.62, 0.5, 0.45, 0.36, 0.3, 0.25, 0.22, 0.18):
        x, y = random.uniform((-1.9, -1.6), (1.9, 2.6))
        for _ in range(50):
            if all(np.hypot(x - a, y - b) > 0.9 * (radius + r) for (a, b), r in placed):
                break
            x, y = random.uniform((-1.9, -1.6), (1.9, 2.6))
        placed.append(((float(x), float(y)), radius))
    return placed
