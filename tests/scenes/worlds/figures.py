# SPDX-License-Identifier: GPL-3.0-or-later
"""Statues, urns and thin rings on a square, under a photograph-like map of a clear sky with the sun in it."""

from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from tests.scenes import blend_file
from tests.scenes.atrium import SceneBuilder
from tests.scenes.parts.architecture import balustrade, urn
from tests.scenes.parts.shapes import box
from tests.scenes.parts.solids import ball, knot
from tests.scenes.parts.statue import statue_mesh

from .maps import clear, world_with

CAMERAS = (((0.3, -6.0, 2.4), (0.0, 0.4, 0.9), 32.0), ((2.6, -5.2, 1.6), (0.0, 0.4, 0.9), 32.0))
SUNS = ((-0.6, -0.5, 0.7), (0.7, -0.3, 0.5))
PLINTH_HEIGHT = 0.35


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    builder, random = SceneBuilder(), np.random.default_rng(740 + variant)
    builder.add("Square", [(box((-30.0, -30.0, -0.2), (30.0, 30.0, 0.0)), "Paving")])
    builder.meshes["Figure"] = statue_mesh()
    for x, y, turn in ((-1.7, 0.6, 0.4), (0.1, 1.4, -0.2), (1.8, 0.3, 0.9)):
        plinth = box((x - 0.4, y - 0.4, 0.0), (x + 0.4, y + 0.4, PLINTH_HEIGHT))
        builder.add(f"Plinth {x}", [(plinth, "Limestone")])
        matrix = Matrix.Translation((x, y, PLINTH_HEIGHT)) @ Matrix.Rotation(turn, 4, "Z") @ Matrix.Scale(0.8, 4)
        builder.add("Figure", [], [matrix])
    builder.add("Rail", [(balustrade(6.0, 19), "Limestone")], [Matrix.Translation((0.0, 3.2, 0.0))])
    builder.add("Urn", [(urn(0.8), "Terracotta")], [Matrix.Translation((x, -0.9, 0.0)) for x in (-2.4, 2.5)])
    things = (("Ball", ball(0.22, 16), "Ochre", 0.22), ("Ring", knot(1, 0, 0.3, 0.015, 64, 8), "Iron", 0.02))
    for name, shape, color, height in things:
        for _ in range(4):
            x, y = random.uniform((-2.2, -2.2), (2.2, -0.3))
            builder.add(name, [(shape, color)], [Matrix.Translation((x, y, height))])
    bpy.context.scene.world = world_with(clear(741 + variant, SUNS[variant]))
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)


def keep_statues() -> None:
    """Leave the open scene's statues, on the ground."""
    for thing in list(bpy.data.objects):
        name = thing.name.partition(".")[0]
        if name == "Figure":
            thing.location.z -= PLINTH_HEIGHT
        elif name not in ("Square", "Camera"):
            bpy.data.objects.remove(thing)
