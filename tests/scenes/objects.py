# SPDX-License-Identifier: GPL-3.0-or-later
"""Many small objects in front of a curved backdrop: balls, rings, knots, blocks, bottles, and gems of few facets."""

import math
from pathlib import Path

import numpy as np
from mathutils import Matrix

from tests.scenes.parts.architecture import urn
from tests.scenes.parts.shapes import Shape, grid, lathe
from tests.scenes.parts.solids import ball, knot, lowest_point

from . import blend_file
from .atrium import SceneBuilder
from .blend_file import COOL, WARM, AreaLight

COUNT, EXTENT = 190, 3.2  # objects, and half the width in m of the area that they lie in

LIGHTS = (
    (
        AreaLight("DISK", (-3.4, -2.2, 3.6), (0.0, 0.4, 0.2), 198.0, (0.5, 0.5), WARM),
        AreaLight("RECTANGLE", (3.6, 0.6, 2.4), (0.2, 0.3, 0.2), 156.0, (2.6, 0.25), COOL),
        AreaLight("SQUARE", (0.4, 2.6, 4.2), (0.0, 0.0, 0.0), 144.0, (1.6, 1.6), spread=120.0),
    ),
    (
        AreaLight("ELLIPSE", (3.0, -3.0, 3.0), (0.0, 0.2, 0.2), 180.0, (0.9, 0.3), WARM),
        AreaLight("SQUARE", (-3.8, 0.2, 2.0), (0.0, 0.3, 0.2), 144.0, (0.35, 0.35), COOL),
        AreaLight("RECTANGLE", (-0.4, 1.8, 4.0), (0.0, 0.2, 0.0), 180.0, (2.2, 1.0)),
    ),
)
CAMERAS = (((1.1, -5.6, 2.3), (0.0, 0.0, 0.3), 40.0), ((-2.4, -4.6, 1.5), (0.1, 0.3, 0.35), 36.0))
COLORS = ("Marble", "Clay", "Ochre", "Teal", "Plum", "Leaf")


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    builder = SceneBuilder()
    builder.add("Backdrop", [(backdrop(), "Paper")])
    scatter(builder, np.random.default_rng(100 + variant))
    blend_file.add_lights(LIGHTS[variant])
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)


def backdrop() -> Shape:
    """A floor that curves up into a wall."""
    bend = np.linspace(0.0, 0.5 * math.pi, 17)
    y = np.concatenate([[-9.0], np.linspace(-5.0, 3.0, 9), 4.0 + 1.5 * np.sin(bend), [5.5]])
    z = np.concatenate([np.zeros(10), 1.5 * (1.0 - np.cos(bend)), [7.0]])
    x = np.linspace(-9.0, 9.0, 25)
    columns = np.broadcast_to(x, (len(y), len(x)))
    rows = [np.broadcast_to(line[:, None], columns.shape) for line in (y, z)]
    return grid(np.stack([columns, *rows], axis=-1), np.stack([columns, rows[0]], axis=-1))


def solids() -> dict[str, Shape]:
    """Solids about as large as a ball of radius 1, from 40 to 8,000 triangles."""
    bottle = np.array([(0.004, -1.0), (0.5, -1.0), (0.55, -0.92), (0.55, 0.1), (0.2, 0.5), (0.2, 0.95), (0.004, 0.96)])
    cone = np.array([(0.004, -0.8), (0.8, -0.8), (0.8, -0.74), (0.05, 0.95), (0.004, 0.97)])
    return {
        "Ball": ball(1.0, 18),
        "Gem": ball(1.0, 3),
        "Block": ball(0.8, 14, 7.0),
        "Ring": knot(1, 0, 0.75, 0.25, 64, 24),
        "Wire ring": knot(1, 0, 0.95, 0.035, 72, 8),
        "Trefoil": knot(2, 3, 0.66, 0.16, 200, 14),
        "Star knot": knot(2, 5, 0.66, 0.085, 320, 12),
        "Bottle": lathe(bottle, 28),
        "Cone": lathe(cone, 12),
        "Jar": urn(1.6).moved(z=-0.8),
    }


def scatter(builder: SceneBuilder, random: np.random.Generator) -> None:
    """Put objects on the floor, the largest first, where they hardly overlap. Some are rotated about a random axis."""
    shapes = solids()
    names = list(shapes)
    radii = np.sort(0.07 + 0.42 * random.random(COUNT) ** 3.0)[::-1]
    taken = np.zeros((0, 3))
    for radius in radii:
        for _ in range(60):
            position = random.uniform((-EXTENT, -0.75 * EXTENT), (EXTENT, 0.75 * EXTENT))
            gaps = np.linalg.norm(taken[:, :2] - position, axis=1) - taken[:, 2] - radius
            if not len(taken) or gaps.min() > -0.15 * radius:
                break
        else:
            continue
        taken = np.vstack([taken, [*position, radius]])
        name, color = names[random.integers(len(names))], COLORS[random.integers(len(COLORS))]
        tumble = Matrix.Rotation(random.uniform(0.0, math.pi), 3, random.normal(size=3))
        upright = Matrix.Rotation(random.uniform(0.0, 2.0 * math.pi), 3, "Z")
        rotation = tumble if name in ("Gem", "Block", "Trefoil", "Star knot", "Wire ring") else upright
        height = -radius * lowest_point(shapes[name], np.array(rotation))
        matrix = Matrix.Translation((*position, height)) @ rotation.to_4x4() @ Matrix.Scale(radius, 4)
        builder.add(f"{name}, {color}", [(shapes[name], color)], [matrix])
