# SPDX-License-Identifier: GPL-3.0-or-later
"""Two trees of 100,000 leaf cards with alpha, on instanced twigs: a lawn, a path, a bench and a fence under the sun."""

from pathlib import Path

import numpy as np
from mathutils import Matrix

from tests.scenes import blend_file
from tests.scenes.atrium import SceneBuilder
from tests.scenes.lights.lamps import add_sun, set_world
from tests.scenes.parts.shapes import grid

from . import tree_shapes as shapes
from .tree_materials import MATERIALS

#: Of each tree: x and y in m, height in m, boughs and twigs.
TREES = ((0.7, 1.8, 6.2, 17, 2600), (-5.0, -3.2, 5.6, 15, 1600))
TWIGS = 6  # different ones
SUN = ((0.3, 0.75, -0.75), (-0.5, 0.5, -0.8))
CAMERAS = (((-1.0, -8.2, 1.7), (-0.3, 1.0, 2.95), 23.0), ((3.4, -6.2, 1.4), (-0.2, 1.4, 2.5), 26.0))


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    builder, random = SceneBuilder(), np.random.default_rng(740 + variant)
    builder.materials.by_name |= {name: make(name) for name, make in MATERIALS.items()}
    lay_ground(builder)
    plant(builder, random)
    slats, sides = shapes.bench()
    place = Matrix.Translation((-0.55, 0.4, 0.03)) @ Matrix.Rotation(-0.25, 4, "Z")
    builder.add("Bench", [(slats, "Weathered wood"), (sides, "Cast iron")], [place])
    fences = [Matrix.Translation((x, 5.6, 0.05)) for x in (-13.2, -0.6)]
    builder.add("Fence", [(shapes.fence(80), "Painted wood")], fences)
    add_sun(SUN[variant], 6.5, (1.0, 0.93, 0.82), 2.0)
    set_world((0.26, 0.34, 0.44))
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)


def lay_ground(builder: SceneBuilder) -> None:
    """A lawn with hills in the distance, and a winding path, 1.2 m wide and 1.5 cm above it."""
    line = np.linspace(-30.0, 30.0, 121)
    x, y = np.meshgrid(line, line, indexing="ij")
    builder.add("Lawn", [(grid(np.stack([x, y, ground(x, y)], -1), np.stack([x, y], -1)), "Lawn")])
    across, along = np.meshgrid(np.linspace(0.0, 1.2, 7), np.linspace(-9.0, 8.0, 121))
    x = across - 2.5 + 0.8 * np.sin(0.45 * along) - 0.03 * along
    strip = np.stack([x, along, ground(x, along) + 0.015], axis=-1)
    builder.add("Path", [(grid(strip, np.stack([across, along], axis=-1)), "Brick paving")])


def ground(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Height of the lawn."""
    return 0.04 * np.sin(1.1 * x) * np.sin(0.8 * y) + 0.03 * np.maximum(np.hypot(x, y) - 9.0, 0.0) ** 1.5


def plant(builder: SceneBuilder, random: np.random.Generator) -> None:
    """The trees, and objects of a few different twigs on them."""
    twigs = [shapes.twig(random) for _ in range(TWIGS)]
    for index, (x, y, height, boughs, count) in enumerate(TREES):
        tree = shapes.grow(random, height, boughs, count)
        place = Matrix.Translation((x, y, 0.0))
        builder.add(f"Tree {index + 1}", [(tree.wood, "Furrowed bark")], [place])
        for each, matrix in enumerate(tree.twigs):
            stem, cards = twigs[each % TWIGS]
            parts = [(stem, "Furrowed bark"), (cards, "Leaf card")]
            builder.add(f"Twig {each % TWIGS + 1}", parts, [place @ matrix])
