# SPDX-License-Identifier: GPL-3.0-or-later
"""A garden under the sun and a sky of one color: hedges, trees of many leaves, a balustrade, urns, and grass."""

import math
from pathlib import Path

import numpy as np
from mathutils import Matrix

from tests.scenes import blend_file
from tests.scenes.atrium import SceneBuilder
from tests.scenes.parts.architecture import balustrade, urn
from tests.scenes.parts.shapes import Shape, box, grid, join
from tests.scenes.parts.solids import ball, tube
from tests.scenes.thin import ground

from .lamps import add_sun, set_world

CAMERAS = (((0.4, -5.4, 1.7), (0.0, 0.6, 0.9), 28.0), ((-2.4, -4.8, 1.6), (0.2, 0.6, 0.9), 28.0))
LEAVES = 900  # of a tree


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    builder, random = SceneBuilder(), np.random.default_rng(730 + variant)
    builder.add("Lawn", [(ground(random), "Grass")])
    builder.add("Path", [(box((-0.8, -6.0, -0.1), (0.8, 2.2, 0.04)), "Sandstone")])
    builder.add("House", [(box((-6.0, 4.6, -0.2), (6.0, 5.0, 3.6)), "Plaster")])
    rails = [Matrix.Translation((x, 2.4, 0.0)) for x in (-2.6, 2.6)]
    builder.add("Rail", [(balustrade(3.4, 11), "Limestone")], rails)
    urns = [Matrix.Translation((x, y, 0.0)) for x in (-1.1, 1.1) for y in (-1.6, 0.2, 2.0)]
    builder.add("Urn", [(urn(0.7), "Terracotta")], urns)
    hedges = [
        Matrix.Translation((x, y, 0.3)) @ Matrix.Diagonal((0.45, 0.4, 0.42, 1.0))
        for x in (-2.2, 2.2)
        for y in np.linspace(-2.0, 1.4, 6)
    ]
    builder.add("Hedge", [(ball(1.0, 16, 3.0), "Leaf")], hedges)
    for index, (x, y) in enumerate(((-2.9, 3.2), (2.7, 3.4), (-3.4, 0.2), (3.3, -0.4))):
        trunk, crown = tree(random)
        builder.add(f"Tree {index}", [(trunk, "Bark"), (crown, "Leaf")], [Matrix.Translation((x, y, 0.0))])
    side = 1.0 - 2.0 * variant
    add_sun((0.62 * side, 0.35, -0.7), 3.2, (1.0, 0.93, 0.82), 0.53)
    set_world((0.12, 0.17, 0.26))
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)


def tree(random: np.random.Generator) -> tuple[Shape, Shape]:
    """A trunk, and leaves in a ball around its upper end."""
    trunk = tube(np.array([(0.0, 0.0, -0.2), (0.04, 0.0, 0.8), (-0.03, 0.05, 1.6), (0.0, 0.0, 2.1)]), 0.07, 10)
    leaves = []
    corners = np.array([[(-1.0, -0.5), (-1.0, 0.5)], [(1.0, -0.5), (1.0, 0.5)]])
    for _ in range(LEAVES):
        direction = random.normal(size=3)
        place = (0.0, 0.0, 2.1) + 0.75 * random.random() ** (1.0 / 3.0) * direction / np.linalg.norm(direction)
        angle, lean = random.uniform(0.0, 2.0 * math.pi, 2)
        u = np.array([math.cos(angle), math.sin(angle), 0.3 * math.sin(lean)])
        v = np.cross(u, [math.sin(lean), math.cos(lean), 1.0])
        positions = place + 0.06 * (corners[..., :1] * u + corners[..., 1:] * v / np.linalg.norm(v))
        leaves.append(grid(positions, 0.1 * corners))
    return trunk, join(leaves)
