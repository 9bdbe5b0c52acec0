# SPDX-License-Identifier: GPL-3.0-or-later
"""A room with two windows, furniture and a curtain, under a map of an overcast sky. It has no other light."""

from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from tests.scenes import blend_file
from tests.scenes.atrium import SceneBuilder
from tests.scenes.parts.architecture import urn
from tests.scenes.parts.cloth import curtain
from tests.scenes.parts.shapes import Shape, box, join
from tests.scenes.parts.solids import ball, rounded_box

from .maps import overcast, world_with

WIDTH, DEPTH, HEIGHT, WALL = 5.0, 6.0, 2.7, 0.25  # m
#: Windows in the wall at x = WIDTH: from and to along y, and along z, m.
WINDOWS = ((0.9, 2.3), (3.4, 4.8)), (0.9, 2.2)
CAMERAS = (((0.5, 0.4, 1.6), (3.6, 4.2, 0.9), 22.0), ((0.6, 5.5, 1.5), (3.8, 1.6, 0.9), 22.0))


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    builder, random = SceneBuilder(), np.random.default_rng(750 + variant)
    builder.add("Floor", [(box((-WALL, -WALL, -0.2), (WIDTH + WALL, DEPTH + WALL, 0.0)), "Oak")])
    builder.add("Ceiling", [(box((-WALL, -WALL, HEIGHT), (WIDTH + WALL, DEPTH + WALL, HEIGHT + 0.2)), "Plaster")])
    walls = [
        box((-WALL, -WALL, 0.0), (0.0, DEPTH + WALL, HEIGHT)),
        box((0.0, -WALL, 0.0), (WIDTH, 0.0, HEIGHT)),
        box((0.0, DEPTH, 0.0), (WIDTH, DEPTH + WALL, HEIGHT)),
    ]
    builder.add("Walls", [(join(walls), "Plaster")])
    builder.add("Wall with windows", [(window_wall(), "Plaster")])
    builder.add("Table", [(table(), "Oak")], [Matrix.Translation((3.2, 3.3, 0.0))])
    builder.add("Sofa", [(sofa(), "Teal")], [Matrix.Translation((1.0, 4.6, 0.0)), Matrix.Translation((1.2, 2.0, 0.0))])
    builder.add("Curtain", [(curtain(0.8, 2.2, 7, 3), "Paper")], [curtain_matrix(y) for y in (0.45, 5.25)])
    builder.add("Vase", [(urn(0.35), "Terracotta")], [Matrix.Translation((3.3, 3.2, 0.76))])
    for index in range(5):
        x, y = random.uniform((2.75, 2.9), (3.7, 3.7))
        builder.add(f"Ball {index}", [(ball(0.06, 12), "Ochre")], [Matrix.Translation((x, y, 0.82))])
    bpy.context.scene.world = world_with(overcast(751 + variant), 3.0)
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)


def window_wall() -> Shape:
    """The wall at x = WIDTH around its windows, with a bar across each."""
    (spans, (low, high)), x = WINDOWS, (WIDTH, WIDTH + WALL)
    edges = [-WALL, *(edge for span in spans for edge in span), DEPTH + WALL]
    parts = [box((x[0], a, 0.0), (x[1], b, HEIGHT)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    for a, b in spans:
        parts += [box((x[0], a, 0.0), (x[1], b, low)), box((x[0], a, high), (x[1], b, HEIGHT))]
        middle = 0.5 * (a + b)
        parts.append(box((x[1] - 0.06, middle - 0.025, low), (x[1], middle + 0.025, high)))
    return join(parts)


def table() -> Shape:
    """A table of four legs, about the origin."""
    legs = [box((x - 0.03, y - 0.03, 0.0), (x + 0.03, y + 0.03, 0.72)) for x in (-0.6, 0.6) for y in (-0.4, 0.4)]
    return join([box((-0.7, -0.5, 0.72), (0.7, 0.5, 0.76)), *legs])


def sofa() -> Shape:
    """A seat with a back and arms, about the origin."""
    parts = [
        ((-0.8, -0.4, 0.1), (0.8, 0.4, 0.45)),
        ((-0.8, 0.25, 0.4), (0.8, 0.5, 0.9)),
        ((-1.0, -0.4, 0.1), (-0.8, 0.5, 0.65)),
        ((0.8, -0.4, 0.1), (1.0, 0.5, 0.65)),
    ]
    return join([rounded_box(low, high, 0.06) for low, high in parts])


def curtain_matrix(y: float) -> Matrix:
    """Beside a window, from the ceiling."""
    return Matrix.Translation((WIDTH - 0.12, y, 2.4)) @ Matrix.Rotation(np.pi / 2.0, 4, "Z")
