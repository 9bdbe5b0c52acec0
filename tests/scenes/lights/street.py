# SPDX-License-Identifier: GPL-3.0-or-later
"""The market of the scene lamps under 60 lights: areas, points, spots, and bulbs and signs that are emissive meshes."""

import math
from pathlib import Path

import numpy as np
from mathutils import Matrix

from tests.scenes import blend_file
from tests.scenes.atrium import SceneBuilder
from tests.scenes.blend_file import COOL, WARM, WHITE, AreaLight
from tests.scenes.lamps import add_market
from tests.scenes.parts.shapes import box
from tests.scenes.parts.solids import ball

from .lamps import add_point, add_spot, emissive

CAMERAS = (((0.2, -3.6, 1.8), (0.1, 1.0, 0.9), 26.0), ((-1.9, -3.6, 1.9), (0.2, 1.1, 0.9), 26.0))
COLORS = (WARM, WHITE, COOL, (1.0, 0.45, 0.3))


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    builder, random = SceneBuilder(), np.random.default_rng(720 + variant)
    add_market(builder, random)
    add_lamps(random)
    add_emitters(builder, random)
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)


def add_lamps(random: np.random.Generator) -> None:
    """Fifteen points, fifteen spots and ten areas above the street."""
    areas = []
    for index in range(40):
        x, y = random.uniform((-3.6, -2.4), (3.6, 2.8))
        place, target = (float(x), float(y), float(random.uniform(2.3, 3.4))), (float(x) + 0.4, float(y) - 0.2, 0.0)
        color, size = COLORS[index % 4], float(0.02 * 10.0 ** random.random())
        if index < 15:
            add_point(place, 7.0, color, size)
        elif index < 30:
            add_spot(place, target, 25.0, color, size, float(random.uniform(35.0, 90.0)), float(random.random()))
        else:
            areas.append(AreaLight("RECTANGLE", place, target, 10.0, (3.0 * size, 2.0 * size), color, 120.0))
    blend_file.add_lights(areas)


def add_emitters(builder: SceneBuilder, random: np.random.Generator) -> None:
    """Sixteen bulbs on a string, and four signs on the house."""
    builder.materials.by_name["Bulb"] = emissive("Bulb", WARM, 12.0)
    bulbs = [
        Matrix.Translation((x, 0.2 + 0.2 * math.sin(3.0 * x), 2.3 + 0.1 * math.cos(4.0 * x)))
        for x in np.linspace(-3.2, 3.2, 16)
    ]
    builder.add("Bulb", [(ball(0.06, 5), "Bulb")], bulbs)
    for index in range(4):
        name = f"Sign {index}"
        builder.materials.by_name[name] = emissive(name, COLORS[index], 6.0)
        x, z = -3.0 + 2.0 * index, float(random.uniform(2.2, 3.0))
        builder.add(name, [(box((-0.4, -0.03, -0.12), (0.4, 0.03, 0.12)), name)], [Matrix.Translation((x, 3.5, z))])
