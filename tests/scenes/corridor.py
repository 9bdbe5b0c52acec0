# SPDX-License-Identifier: GPL-3.0-or-later
"""A narrow corridor of pillars, with area lights very close to the surfaces that they light."""

import math
from pathlib import Path

import numpy as np
from mathutils import Matrix

from tests.scenes.parts.architecture import groin_vault, pier, pillar, urn
from tests.scenes.parts.shapes import box
from tests.scenes.parts.solids import ball

from . import blend_file
from .atrium import SceneBuilder
from .blend_file import COOL, WARM, WHITE, AreaLight

HALF, HEIGHT, BAY, BAYS = 1.25, 2.9, 1.8, 7  # m: to the walls, to the vaults, from pillar to pillar; and bays
INSET = 0.27  # m, from a wall to its pillars' axes

# One light shines down from the vaults, one up a wall 6 cm away, one on a pillar 8 cm away, one on a crate 5 mm away.
LIGHTS = (
    (
        AreaLight("RECTANGLE", (0.0, 3.6, 2.72), (0.0, 3.6, 0.0), 100.0, (0.5, 1.2), WHITE),
        AreaLight("RECTANGLE", (-1.19, 2.7, 0.5), (-1.15, 2.7, 2.0), 17.0, (1.3, 0.03), WARM),
        AreaLight("SQUARE", (0.63, 5.4, 1.2), (0.98, 5.4, 1.25), 2.3, (0.3, 0.3), COOL),
        AreaLight("DISK", (0.55, 2.2, 0.505), (0.55, 2.2, 0.0), 0.08, (0.12, 0.12), WARM),
        AreaLight("ELLIPSE", (0.2, 10.6, 2.3), (0.0, 8.6, 0.4), 150.0, (0.5, 0.2), WARM, 130.0),
    ),
    (
        AreaLight("SQUARE", (0.1, 5.4, 2.75), (0.1, 5.4, 0.0), 110.0, (0.7, 0.7), WHITE),
        AreaLight("RECTANGLE", (1.17, 4.5, 0.35), (1.13, 4.5, 2.0), 18.0, (1.2, 0.025), COOL),
        AreaLight("ELLIPSE", (-0.6, 3.6, 1.4), (-0.98, 3.6, 1.35), 2.0, (0.35, 0.2), WARM),
        AreaLight("RECTANGLE", (-0.55, 2.6, 0.506), (-0.55, 2.6, 0.0), 0.08, (0.2, 0.06), WARM),
        AreaLight("DISK", (-0.2, 11.2, 2.2), (0.0, 9.0, 0.4), 150.0, (0.35, 0.35), WARM, 120.0),
    ),
)
CAMERAS = (((0.35, -0.6, 1.45), (-0.1, 4.0, 1.15), 24.0), ((-0.45, 0.2, 1.2), (0.15, 5.0, 1.2), 24.0))


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    builder, random = SceneBuilder(), np.random.default_rng(400 + variant)
    length = BAY * BAYS
    shell = [box((-HALF - 0.3, -2.0, -0.2), (HALF + 0.3, length + 0.3, 0.0))]
    shell += [box((s - 0.15, -2.0, -0.1), (s + 0.15, length + 0.3, 3.6)) for s in (-HALF - 0.15, HALF + 0.15)]
    for wall in (*shell, box((-HALF, length, 0.0), (HALF, length + 0.3, 3.6))):
        builder.add(f"Wall {len(builder.meshes)}", [(wall, "Concrete")])
    add_colonnade(builder)
    furnish(builder, random, 1.0 - 2.0 * variant)
    blend_file.add_lights(LIGHTS[variant])
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)


def add_colonnade(builder: SceneBuilder) -> None:
    """Pillars along both walls, blocks on top of them, and vaults."""
    shaft, ends = pillar(2.2, 0.13, 0.36, flutes=12)
    feet = [Matrix.Translation((s * (HALF - INSET), BAY * bay, 0.0)) for s in (-1, 1) for bay in range(BAYS + 1)]
    builder.add("Pillar", [(shaft, "Marble"), (ends, "Paper")], feet)
    above = [foot @ Matrix.Translation((0.0, 0.0, 2.2)) for foot in feet]
    builder.add("Block", [(pier(HEIGHT - 2.2, 0.15), "Paper")], above)
    vault = groin_vault(HALF, 0.5 * BAY, 2.35, 0.5)
    middles = [Matrix.Translation((0.0, BAY * (bay + 0.5), 0.0)) for bay in range(-1, BAYS)]
    builder.add("Vault", [(vault, "Paper")], middles)


def furnish(builder: SceneBuilder, random: np.random.Generator, side: float) -> None:
    """Crates, jars and balls along the walls, and the crate that the lowest light almost touches."""
    builder.add("Crate", [(box((-0.22, -0.22, 0.0), (0.22, 0.22, 0.5)), "Ochre")], [
        Matrix.Translation((0.55 * side, 2.4 - 0.2 * side, 0.0)) @ Matrix.Rotation(0.3, 4, "Z"),
    ])  # fmt: skip
    jar = urn(0.6)
    for bay in range(1, BAYS):
        x = 0.62 * (-1.0) ** bay * side
        matrix = Matrix.Translation((x, BAY * bay - 0.7, 0.0)) @ Matrix.Rotation(random.uniform(0.0, math.pi), 4, "Z")
        builder.add("Jar", [(jar, "Terracotta")], [matrix @ Matrix.Scale(random.uniform(0.7, 1.1), 4)])
        for _ in range(4):
            radius = random.uniform(0.04, 0.11)
            position = (random.uniform(-0.8, 0.8), BAY * bay + random.uniform(-0.6, 0.8), radius)
            color = ("Teal", "Clay", "Plum")[random.integers(3)]
            builder.add(
                f"Ball, {color}", [(ball(1.0, 8), color)], [Matrix.Translation(position) @ Matrix.Scale(radius, 4)]
            )
