# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin objects: grass, a wire fence, a grille, twigs with leaves; lit from the front and from behind."""

from pathlib import Path

import numpy as np
from mathutils import Matrix

from tests.scenes.parts.shapes import Shape, box, grid, join
from tests.scenes.parts.solids import tube

from . import blend_file
from .atrium import SceneBuilder
from .blend_file import COOL, WARM, AreaLight

TUFTS, BLADES = 330, 45  # tufts of grass, and blades in each
LIGHTS = (
    (
        AreaLight("DISK", (-2.6, -2.4, 3.4), (0.1, 0.4, 0.2), 450.0, (0.35, 0.35), WARM),
        AreaLight("RECTANGLE", (1.9, 4.2, 2.3), (0.0, 0.2, 0.2), 495.0, (1.6, 0.7), COOL),
    ),
    (
        AreaLight("SQUARE", (2.8, -2.0, 2.8), (0.0, 0.4, 0.2), 390.0, (0.3, 0.3), WARM),
        AreaLight("ELLIPSE", (-2.2, 4.0, 2.0), (0.0, 0.3, 0.2), 480.0, (1.2, 0.5), COOL),
    ),
)
CAMERAS = (((0.4, -1.7, 0.62), (0.02, 0.6, 0.42), 30.0), ((-0.7, -1.6, 0.85), (0.1, 0.6, 0.36), 30.0))


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    builder, random = SceneBuilder(), np.random.default_rng(200 + variant)
    builder.add("Ground", [(ground(random), "Earth")])
    builder.add("Wall", [(box((-6.0, 5.2, -0.5), (6.0, 5.4, 3.2)), "Concrete")])
    plant_grass(builder, random)
    side = 1.0 - 2.0 * variant
    builder.add("Fence", [(fence(1.7, 0.95), "Iron")], [Matrix.Translation((-0.75 * side, 1.15, 0.0))])
    grille_matrix = Matrix.Translation((0.95 * side, 0.75, 0.0)) @ Matrix.Rotation(-0.5 * side, 4, "Z")
    builder.add("Grille", [(grille(0.8, 0.75), "Bronze")], [grille_matrix])
    for x, y, angle in ((0.1, 0.75, 0.3), (1.35, 1.5, 2.2), (-1.3, 1.9, 4.0)):
        matrix = Matrix.Translation((x * side, y, 0.0)) @ Matrix.Rotation(angle, 4, "Z")
        bark, leaves = sapling(random)
        builder.add(f"Sapling at {x}", [(bark, "Bark"), (leaves, "Leaf")], [matrix])
    blend_file.add_lights(LIGHTS[variant])
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)


def ground(random: np.random.Generator) -> Shape:
    """Soil with low waves, level at the origin."""
    line = np.linspace(-6.0, 6.0, 121)
    x, y = np.meshgrid(line, line, indexing="ij")
    z = np.zeros_like(x)
    for frequency in (2.0, 5.0, 11.0):
        a, b, phase = random.uniform(-1.0, 1.0, 3) * (frequency, frequency, 3.0)
        z += 0.02 / frequency**0.7 * np.sin(a * x + b * y + phase)
    return grid(np.stack([x, y, z], axis=-1), np.stack([x, y], axis=-1))


def blade(height: float, width: float, lean: float, angle: float, steps: int = 6) -> Shape:
    """A sheet that grows upwards from the origin, narrows to a tip and leans over."""
    t = np.linspace(0.0, 1.0, steps + 1)[:, None]
    half = 0.5 * width * (1.0 - t**2) + 2e-4
    across = np.concatenate([-half, half], axis=1)
    fold = np.abs(across) * 0.3
    x = np.broadcast_to(lean * t**2, across.shape) + fold
    z = np.broadcast_to(height * (t - 0.25 * (lean / height) ** 2 * t**3), across.shape)
    shape = grid(np.stack([x, across, z], axis=-1), np.stack([across, z], axis=-1))
    return shape.moved(angle=angle)


def plant_grass(builder: SceneBuilder, random: np.random.Generator) -> None:
    """Tufts of a few shapes, with a path between them."""
    shapes = [tuft(random) for _ in range(6)]
    for index in range(TUFTS):
        x, y = random.uniform((-2.4, -0.9), (2.4, 3.2))
        if abs(x) < 0.35 and y < 0.5:
            continue
        size = random.uniform(0.6, 1.25)
        matrix = Matrix.Translation((x, y, -0.01)) @ Matrix.Rotation(random.uniform(0.0, 6.3), 4, "Z")
        choice = index % len(shapes)
        builder.add(f"Tuft {choice + 1}", [(shapes[choice], "Grass")], [matrix @ Matrix.Scale(size, 4)])


def tuft(random: np.random.Generator) -> Shape:
    """Blades of 6 to 39 cm that grow within a radius of 12 cm."""
    blades = []
    for _ in range(BLADES):
        height = random.uniform(0.08, 0.3) * random.uniform(0.7, 1.3)
        angle, distance, around = random.uniform(0.0, 6.3), 0.12 * random.random() ** 0.5, random.uniform(0.0, 6.3)
        one = blade(height, random.uniform(0.003, 0.008), height * random.uniform(0.15, 0.9), angle)
        blades.append(one.moved(x=distance * np.cos(around), y=distance * np.sin(around)))
    return join(blades)


def fence(width: float, height: float) -> Shape:
    """Woven wire between two posts, along x."""
    wires = []
    mesh, radius, amplitude = 0.085, 0.0022, 0.006
    for direction in (-1.0, 1.0):
        for start in np.arange(-0.5 * width - height, 0.5 * width, mesh):
            t = np.linspace(0.0, 1.0, 2 * int(height / mesh) + 1)
            x = start + height * (t if direction > 0.0 else 1.0 - t)
            y = direction * amplitude * np.cos(np.pi * np.arange(len(t)))
            inside = np.abs(x) <= 0.5 * width
            if inside.sum() > 1:
                path = np.stack([x, y, 0.04 + (height - 0.06) * t], axis=-1)[inside]
                wires.append(tube(path, radius, 5))
    for z in (0.03, height):
        line = np.array([(-0.5 * width, 0.0, z), (0.0, 0.0, z), (0.5 * width, 0.0, z)])
        wires.append(tube(line, 0.005, 8))
    for x in (-0.5 * width, 0.5 * width):
        wires.append(tube(np.array([(x, 0.0, -0.1), (x, 0.0, 0.5), (x, 0.0, height + 0.08)]), 0.018, 12))
    return join(wires)


def grille(width: float, height: float) -> Shape:
    """Upright bars and flat slats in a frame, along x."""
    bars = []
    for x in np.linspace(-0.5 * width, 0.5 * width, 15)[1:-1]:
        bars.append(tube(np.array([(x, 0.0, 0.03), (x, 0.0, 0.5 * height), (x, 0.0, height)]), 0.004, 8))
    for z in np.linspace(0.03, height, 5):
        bars.append(box((-0.5 * width, -0.004, z - 0.008), (0.5 * width, 0.004, z + 0.008)))
    for x in (-0.5 * width, 0.5 * width):
        bars.append(box((x - 0.015, -0.015, -0.05), (x + 0.015, 0.015, height + 0.03)))
    return join(bars)


def sapling(random: np.random.Generator) -> tuple[Shape, Shape]:
    """A stem with twigs, and its leaves."""
    wood, leaves = [], []
    t = np.linspace(0.0, 1.0, 12)
    sway = random.uniform(-0.12, 0.12, 2)
    height = random.uniform(0.75, 1.0)
    stem = np.stack([sway[0] * t**2, sway[1] * t**2, height * t - 0.03], axis=-1)
    wood.append(tube(stem, 0.011 * (1.0 - 0.75 * t), 8))
    for index in range(13):
        foot = stem[4:-1][index % 7]
        angle = 2.4 * index + random.uniform(-0.3, 0.3)
        direction = np.array([np.cos(angle), np.sin(angle), random.uniform(0.3, 0.9)])
        s = np.linspace(0.0, 1.0, 7)[:, None]
        length = random.uniform(0.18, 0.36)
        twig = foot + length * s * direction + length * s**2 * (0.0, 0.0, -0.12)
        wood.append(tube(twig, 0.0035 * (1.0 - 0.7 * s[:, 0]), 5))
        leaves += [leaf(random).moved(*tip, angle=0.0) for tip in twig[2:] for _ in range(2)]
    return join(wood), join(leaves)


def leaf(random: np.random.Generator) -> Shape:
    """A pointed sheet, folded along its middle and bent down, with a random rotation about the vertical."""
    t = np.linspace(0.0, 1.0, 7)[:, None]
    length = random.uniform(0.05, 0.09)
    across = 0.26 * length * np.sin(np.pi * np.clip(t, 0.02, 0.98)) ** 0.8 * np.linspace(-1.0, 1.0, 5)
    x = np.broadcast_to(length * t, across.shape)
    z = 0.35 * np.abs(across) - 0.35 * length * t**2 + random.uniform(-0.02, 0.02) * t
    roll = random.uniform(-0.8, 0.8)
    y, z = np.cos(roll) * across - np.sin(roll) * z, np.sin(roll) * across + np.cos(roll) * z
    return grid(np.stack([x, y, z], axis=-1), np.stack([x, across], axis=-1)).moved(angle=random.uniform(0.0, 6.3))
