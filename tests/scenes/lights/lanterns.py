# SPDX-License-Identifier: GPL-3.0-or-later
"""A terrace at night, lit by three emissive meshes: a paper globe, a ring and a knot of neon; 6,600 triangles."""

from pathlib import Path

import numpy as np
from mathutils import Matrix

from tests.scenes import blend_file
from tests.scenes.atrium import SceneBuilder
from tests.scenes.parts.architecture import balustrade, pillar, urn
from tests.scenes.parts.shapes import box
from tests.scenes.parts.solids import ball, knot

from .lamps import emissive

CAMERAS = (((0.6, -4.6, 2.0), (0.0, 0.6, 0.9), 27.0), ((-1.9, -4.2, 1.7), (0.2, 0.7, 0.9), 27.0))
#: Color and W/(sr m²).
PAPER, RING, NEON = ((1.0, 0.72, 0.40), 4.0), ((0.55, 0.75, 1.0), 5.0), ((1.0, 0.3, 0.35), 5.0)


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    builder, random = SceneBuilder(), np.random.default_rng(700 + variant)
    builder.add("Floor", [(box((-6.0, -6.0, -0.2), (6.0, 6.0, 0.0)), "Paving")])
    builder.add("Wall", [(box((-6.0, 3.2, 0.0), (6.0, 3.5, 4.0)), "Plaster")])
    rail = [Matrix.Translation((x, 2.4, 0.0)) for x in (-2.0, 2.0)]
    builder.add("Rail", [(balustrade(3.4, 11), "Limestone")], rail)
    shaft, ends = pillar(2.4, 0.16, 0.5, flutes=12)
    pillars = [Matrix.Translation((x, 1.3, 0.0)) for x in (-2.4, 0.0, 2.4)]
    builder.add("Pillar", [(shaft, "Marble"), (ends, "Limestone")], pillars)
    for name, shape, color, count in (("Urn", urn(0.8), "Terracotta", 6), ("Ball", ball(0.2, 12), "Teal", 9)):
        for _ in range(count):
            x, y = random.uniform((-2.8, -1.6), (2.8, 1.0))
            height = 0.2 if name == "Ball" else 0.0
            builder.add(name, [(shape, color)], [Matrix.Translation((x, y, height))])
    side = 1.0 - 2.0 * variant
    lanterns = (
        ("Paper globe", ball(0.42, 12, 2.4), PAPER, (-1.2 * side, 0.2, 1.3)),
        ("Ring", knot(1, 0, 0.36, 0.1, 64, 12), RING, (1.4 * side, 0.5, 0.9)),
        ("Knot", knot(2, 3, 0.32, 0.07, 200, 8), NEON, (0.1 * side, -0.9, 0.45)),
    )
    for name, shape, (color, strength), place in lanterns:
        builder.materials.by_name[name] = emissive(name, color, strength)
        tilt = Matrix.Rotation(0.9, 4, "X") if name != "Paper globe" else Matrix()
        builder.add(name, [(shape, name)], [Matrix.Translation(place) @ tilt])
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)
