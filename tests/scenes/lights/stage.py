# SPDX-License-Identifier: GPL-3.0-or-later
"""A stage: seven spots with soft and hard edges on figures before a curtain, and four small points as footlights."""

from pathlib import Path

import numpy as np
from mathutils import Matrix

from tests.scenes import blend_file
from tests.scenes.atrium import SceneBuilder
from tests.scenes.blend_file import COOL, WARM, WHITE
from tests.scenes.parts.cloth import curtain, swag
from tests.scenes.parts.shapes import box
from tests.scenes.parts.solids import ball, knot
from tests.scenes.parts.statue import statue_mesh

from .lamps import add_point, add_spot

CAMERAS = (((0.0, -6.4, 1.9), (0.0, 0.4, 1.2), 30.0), ((2.2, -5.6, 1.5), (0.0, 0.4, 1.1), 30.0))


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    builder, random = SceneBuilder(), np.random.default_rng(710 + variant)
    builder.add("Stage", [(box((-4.0, -2.0, -0.4), (4.0, 3.0, 0.0)), "Oak")])
    builder.add("Curtain", [(curtain(6.4, 3.8, 22, 3), "Red damask")], [Matrix.Translation((0.0, 2.2, 3.8))])
    builder.add("Swag", [(swag(6.4, 0.9, 0.5, 4), "Red damask")], [Matrix.Translation((0.0, 1.6, 3.7))])
    builder.meshes["Figure"] = statue_mesh()
    side = 1.0 - 2.0 * variant
    for x, y, turn in ((-1.5, 0.4, 0.4), (0.1, 0.9, -0.2), (1.6, 0.2, 0.9)):
        matrix = Matrix.Translation((x * side, y, 0.0)) @ Matrix.Rotation(turn, 4, "Z") @ Matrix.Scale(0.9, 4)
        builder.add("Figure", [], [matrix])
    props = (("Block", ball(0.22, 10, 6.0), "Ochre", 0.22), ("Hoop", knot(1, 0, 0.3, 0.03, 64, 10), "Bronze", 0.03))
    for name, shape, color, height in props:
        for _ in range(4):
            x, y = random.uniform((-2.6, -1.2), (2.6, 0.2))
            builder.add(name, [(shape, color)], [Matrix.Translation((x, y, height))])
    spots = (
        ((-3.0, -3.2, 4.4), (-1.5, 0.4, 1.0), 900.0, WARM, 0.05, 26.0, 0.15),
        ((3.0, -3.2, 4.4), (1.6, 0.2, 1.0), 900.0, COOL, 0.05, 26.0, 0.15),
        ((0.0, -3.6, 4.8), (0.1, 0.9, 1.0), 1000.0, WHITE, 0.08, 22.0, 0.05),
        ((-3.6, 0.6, 4.0), (0.3, 0.5, 0.3), 500.0, (1.0, 0.3, 0.5), 0.12, 40.0, 0.6),
        ((3.6, 0.6, 4.0), (-0.3, 0.5, 0.3), 500.0, (0.3, 0.5, 1.0), 0.12, 40.0, 0.6),
        ((-1.4, 1.9, 4.2), (-1.2, 0.2, 0.0), 350.0, WHITE, 0.03, 50.0, 1.0),
        ((1.4, 1.9, 4.2), (1.2, 0.2, 0.0), 350.0, WHITE, 0.0, 50.0, 1.0),
    )
    for (x, y, z), (tx, ty, tz), watts, color, radius, degrees, blend in spots:
        add_spot((x * side, y, z), (tx * side, ty, tz), watts, color, radius, degrees, blend)
    for x in (-2.4, -0.8, 0.8, 2.4):
        add_point((x, -1.7, 0.12), 9.0, WARM, 0.04)
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)
