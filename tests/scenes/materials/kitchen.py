# SPDX-License-Identifier: GPL-3.0-or-later
"""A kitchen of 45 materials with node graphs: the sun and the sky through a window and a wide door, and lamps."""

import math
from pathlib import Path

import numpy as np
from mathutils import Matrix

from tests.scenes import blend_file
from tests.scenes.atrium import SceneBuilder
from tests.scenes.blend_file import WARM, WHITE, AreaLight, Point
from tests.scenes.lights.lamps import add_point, add_sun, set_world
from tests.scenes.parts.cloth import curtain
from tests.scenes.parts.shapes import Shape, box, join, ring
from tests.scenes.parts.solids import rounded_box

from . import kitchen_props as props
from . import kitchen_shapes as shapes
from .kitchen_surfaces import SURFACES
from .kitchen_things import THINGS

HALF, BACK, DOOR, HEIGHT = 2.1, 1.6, -3.6, 2.6  # m: x of the side walls, y of the back wall and the door, ceiling
COUNTER, DEPTH = 0.9, 0.6  # m: height and depth of the counter
WINDOW = (-0.75, 0.85, 1.05, 2.2)  # m: y and z of the hole in the left wall
TABLE = (0.45, -0.95)  # m
SHELVES = (1.42, 1.82)  # m, heights
PENDANTS = ((0.1, -0.95), (0.8, -0.95))
SUN = ((0.8, -0.25, -0.38), (0.8, 0.05, -0.5))
CAMERAS = (((0.95, -3.35, 1.55), (-0.2, 0.6, 1.06), 22.0), ((1.75, -2.2, 1.5), (-0.75, 0.9, 1.0), 22.0))


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    builder, random = SceneBuilder(), np.random.default_rng(750 + variant)
    builder.materials.by_name |= {name: make(name) for name, make in (SURFACES | THINGS).items()}
    add_room(builder)
    add_cabinets(builder)
    set_counters(builder, random)
    fill_shelves(builder, random)
    lay_table(builder, random)
    builder.add("Pendant", shapes.pendant(0.75), [at(x, y, HEIGHT) for x, y in PENDANTS])
    add_lights(variant)
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)


def at(x: float, y: float, z: float = 0.0, angle: float = 0.0) -> Matrix:
    """A position in m and a rotation in rad about the vertical."""
    return Matrix.Translation((x, y, z)) @ Matrix.Rotation(angle, 4, "Z")


def add_room(builder: SceneBuilder) -> None:
    """Floor, ceiling and walls, the window with its curtain, the tiles, and a rug."""
    y0, y1, z0, z1 = WINDOW
    walls = (
        ((-HALF - 0.2, DOOR, 0.0), (-HALF, y0, HEIGHT)),
        ((-HALF - 0.2, y1, 0.0), (-HALF, BACK, HEIGHT)),
        ((-HALF - 0.2, y0, 0.0), (-HALF, y1, z0)),
        ((-HALF - 0.2, y0, z1), (-HALF, y1, HEIGHT)),
        ((-HALF - 0.2, BACK, 0.0), (HALF + 0.2, BACK + 0.2, HEIGHT)),
        ((HALF, DOOR, 0.0), (HALF + 0.2, BACK, HEIGHT)),
    )
    for index, (low, high) in enumerate(walls, 1):
        builder.add(f"Wall {index}", [(box(low, high), "Wall paint")])
    builder.add("Floor", [(box((-HALF, DOOR, -0.1), (HALF, BACK, 0.0)), "Floor boards")])
    builder.add(
        "Ceiling", [(box((-HALF - 0.2, DOOR, HEIGHT), (HALF + 0.2, BACK + 0.2, HEIGHT + 0.1)), "Ceiling paint")]
    )
    builder.add("Skirting", [(box((HALF - 0.015, DOOR, 0.0), (HALF, 0.9, 0.09)), "White paint")])
    builder.add("Tiles", [(box((-HALF, BACK - 0.008, COUNTER), (1.4, BACK, 1.55)), "Wall tiles")])
    builder.add("Window tiles", [(box((-HALF, -1.4, COUNTER), (-HALF + 0.008, BACK, z0)), "Wall tiles")])
    profile = [(0.0, -0.03), (0.0, 0.03), (-0.05, 0.03), (-0.05, -0.03), (0.0, -0.03)]
    upright = at(-HALF - 0.08, 0.5 * (y0 + y1), 0.5 * (z0 + z1)) @ Matrix.Rotation(0.5 * math.pi, 4, "Y")
    half_y, half_z = 0.5 * (y1 - y0), 0.5 * (z1 - z0)
    bars = [
        rounded_box((-half_z, -0.02, -0.02), (half_z, 0.02, 0.02), 0.004, 1),
        box((-0.01, -half_y, -0.01), (0.01, half_y, 0.01)),
    ]
    builder.add("Window frame", [(join([ring(profile, half_z, half_y), *bars]), "White paint")], [upright])
    builder.add(
        "Sill",
        [(rounded_box((-HALF - 0.1, y0 - 0.05, z0 - 0.03), (-HALF + 0.06, y1 + 0.05, z0), 0.006, 2), "Veined marble")],
    )
    right = at(HALF, -0.35, 1.6, -0.5 * math.pi)
    builder.add("Picture", shapes.picture(), [right])
    cloth = curtain(0.42, 1.25, 5, 5)
    hung = [at(-HALF + 0.06, y, z1 + 0.08, 0.5 * math.pi) for y in (y0 - 0.1, y1 + 0.12)]
    builder.add("Curtain", [(cloth, "Gingham")], hung)
    builder.add(
        "Rug",
        [(rounded_box((-0.85, -0.6, 0.0), (0.85, 0.6, 0.012), 0.005, 2), "Carpet")],
        [at(-0.1, -0.9, 0.001, 0.05)],
    )


def add_cabinets(builder: SceneBuilder) -> None:
    """Two runs of cabinets with counters, wall cabinets, hood, hob, sink, tap and fridge."""
    quarter = 0.5 * math.pi
    runs = (
        (at(-1.5, BACK - 0.58), ("doors", "drawers", "doors", "oven", "narrow")),
        (at(-1.52, -1.4, 0.0, quarter), ("drawers", "doors", "doors", "doors")),
    )
    for frame, kinds in runs:
        for index, kind in enumerate(kinds):
            if kind != "narrow":
                parts = shapes.base_unit(kind, "Cabinet paint")
                builder.add(f"Base cabinet, {kind}", parts, [frame @ at(shapes.UNIT * index, 0.0)])
    narrow = [
        (box((0.0, 0.0, 0.0), (0.5, 0.57, 0.86)), "White paint"),
        (shapes.front(0.5, 0.76).moved(z=0.1), "Cabinet paint"),
    ]
    builder.add("Narrow cabinet", narrow, [at(0.9, BACK - 0.58)])
    builder.add("Wall cabinet", shapes.wall_unit(0.8, "Oak front"), [at(-0.5, BACK - 0.34, 1.5)])
    builder.add("Small wall cabinet", shapes.wall_unit(0.42, "Oak front"), [at(0.95, BACK - 0.34, 1.5)])
    builder.add("Fridge", shapes.fridge(), [at(1.41, BACK - 0.62)])
    builder.add("Hood", shapes.hood(), [at(0.62, BACK, 1.55)])
    builder.add("Hob", shapes.hob(), [at(0.6, BACK - 0.3, COUNTER)])
    low, middle = COUNTER - 0.04, (-HALF + 0.31, 0.05)
    hole = (middle[0] - 0.19, middle[0] + 0.19, middle[1] - 0.25, middle[1] + 0.25)
    edge = -HALF + DEPTH + 0.02
    slabs = (
        ((-HALF, BACK - DEPTH - 0.02), (1.4, BACK)),
        ((-HALF, -1.42), (edge, hole[2])),
        ((-HALF, hole[3]), (edge, BACK - DEPTH - 0.02)),
        ((-HALF, hole[2]), (hole[0], hole[3])),
        ((hole[1], hole[2]), (edge, hole[3])),
    )
    for index, (first, last) in enumerate(slabs, 1):
        builder.add(f"Counter {index}", [(rounded_box((*first, low), (*last, COUNTER), 0.003, 1), "Granite")])
    builder.add("Sink", [(shapes.sink(), "Sink steel")], [at(*middle, COUNTER, quarter)])
    builder.add("Tap", [(shapes.tap(), "Tap chrome")], [at(-HALF + 0.08, middle[1], COUNTER)])


def set_counters(builder: SceneBuilder, random: np.random.Generator) -> None:
    """Pots on the hob, tins and a basket beside it, basil at the window, a towel at the oven."""
    y = BACK - 0.3
    builder.add("Copper pot", [(props.pot(0.11, 0.13), "Copper")], [at(0.46, y + 0.12, 0.92)])
    builder.add("Red pot", [(props.pot(0.1, 0.1), "Speckled enamel")], [at(0.74, y + 0.12, 0.92, 0.4)])
    builder.add("Pan", [(props.pan(0.12), "Iron pan")], [at(0.73, y - 0.13, 0.92, -0.5)])
    row(builder, "Tin", props.tin(), "Tin", 5, (-0.45, BACK - 0.12, COUNTER), 0.105)
    builder.add("Board", [(props.board(), "Chopping board")], [
        at(1.13, BACK - 0.1, COUNTER + 0.145) @ Matrix.Rotation(0.5 * math.pi - 0.15, 4, "X"),
    ])  # fmt: skip
    builder.add("Crock", [(props.bowl(0.12), "Brown glaze")], [at(0.1, y, COUNTER)])
    builder.add("Basket", [(props.basket(), "Wicker")], [at(-1.75, 1.2, COUNTER)])
    builder.add("Loaf", [(props.loaf(), "Crust")], [at(-1.75, 1.2, COUNTER + 0.12) @ Matrix.Rotation(0.9, 4, "Y")])
    plant = [(props.flower_pot(), "Flower pot"), (props.basil(random), "Basil")]
    builder.add("Basil", plant, [at(-HALF - 0.01, y, 1.05) for y in (-0.5, 0.62)])
    builder.add("Towel", [(props.towel(), "Tea towel")], [at(0.6, BACK - 0.66, 0.66)])
    row(builder, "Tumbler", props.tumbler(), "Green plastic", 2, (-HALF + 0.2, -0.75, COUNTER), 0.11)
    row(builder, "Blue tumbler", props.tumbler(), "Blue plastic", 2, (-HALF + 0.24, -0.9, COUNTER), 0.1)
    builder.add(
        "Plate", [(props.plate(), "Plate")], [at(-HALF + 0.33, -0.55, COUNTER + 0.012 * each) for each in range(6)]
    )


def fill_shelves(builder: SceneBuilder, random: np.random.Generator) -> None:
    """Two shelves on the back wall with crockery and books, and a clock."""
    x0, y = -1.95, BACK - 0.12
    for height in SHELVES:
        builder.add("Shelf", [(props.shelf(1.3), "Beech")], [at(x0, BACK - 0.008, height)])
    row(builder, "Mug", props.mug(), "Striped glaze", 5, (x0 + 0.14, y, SHELVES[0]), 0.13)
    row(builder, "Cup", props.mug(), "Clay cup", 3, (x0 + 0.85, y, SHELVES[0]), 0.14)
    piles = [at(x0 + 0.2, y, SHELVES[1] + 0.014 * each) for each in range(9)]
    builder.add("Small plate", [(props.plate(0.1), "Plate")], piles)
    builder.add(
        "Bowl", [(props.bowl(0.1), "Brown glaze")], [at(x0 + 0.48, y, SHELVES[1] + 0.03 * each) for each in range(3)]
    )
    x = x0 + 0.7
    for index in range(11):
        width = 0.02 + 0.004 * (7 * index % 6)
        size = Matrix.Scale(random.uniform(0.85, 1.0), 4, (0.0, 0.0, 1.0))
        builder.add(f"Book {width:.3f}", [(props.book(width), "Book")], [at(x, y, SHELVES[1]) @ size])
        x += width + 0.002
    builder.add("Clock", shapes.clock(), [at(-1.35, BACK, 2.3)])


def lay_table(builder: SceneBuilder, random: np.random.Generator) -> None:
    """The table with fruit, bread on a board, plates and mugs, and two chairs."""
    x, y, z = *TABLE, 0.75
    builder.add("Table", [(shapes.table(), "Walnut")], [at(x, y)])
    builder.add("Chair", shapes.chair(), [at(x - 0.95, y - 0.1, 0.012, 1.9), at(x + 0.3, y + 0.62, 0.0, 0.25)])
    bowl, radius = at(x + 0.2, y + 0.08, z), 0.17
    builder.add("Fruit bowl", [(props.bowl(radius), "Olive wood")], [bowl])
    fruits = (
        ("Apple", props.apple(), "Apple"),
        ("Orange", props.citrus(0.07), "Orange"),
        ("Lemon", props.citrus(0.095), "Lemon"),
    )
    layers = ((0, 0.0, 0.02), *((k, 0.085, 0.045) for k in range(6)), *((k + 0.5, 0.045, 0.098) for k in range(3)))
    for index, (k, out, up) in enumerate(layers):
        angle = k * 2.0 * math.pi / (6 if out > 0.05 else 3)
        name, shape, material = fruits[index % 3]
        place = bowl @ at(out * math.cos(angle), out * math.sin(angle), up, random.uniform(0.0, 6.3))
        builder.add(name, [(shape, material)], [place @ Matrix.Rotation(random.uniform(-0.4, 0.4), 4, "X")])
    builder.add("Apple", [], [at(x + 0.48, y - 0.16, z, 1.0)])
    board = at(x - 0.28, y - 0.08, z, 0.3)
    builder.add("Board", [], [board])
    builder.add("Loaf", [], [board @ at(-0.03, 0.02, 0.03, 0.2)])
    blade, grip = props.knife()
    builder.add("Knife", [(blade, "Tap chrome"), (grip, "Plinth")], [board @ at(0.05, -0.1, 0.031, 0.1)])
    builder.add("Plate", [], [at(x + 0.47, y + 0.22, z), at(x + 0.05, y - 0.22, z)])
    builder.add("Mug", [], [at(x - 0.5, y + 0.22, z, 2.0), at(x + 0.3, y - 0.26, z, -0.7)])
    builder.add("Tumbler", [], [at(x - 0.12, y + 0.26, z)])


def row(builder: SceneBuilder, name: str, shape: Shape, material: str, count: int, first: Point, step: float) -> None:
    """Objects in a row along x, each turned a little further."""
    x, y, z = first
    places = [at(x + step * index, y, z, 0.5 + 0.35 * index) for index in range(count)]
    builder.add(name, [(shape, material)], places)


def add_lights(variant: int) -> None:
    """The sun, the sky, two pendants above the table, and strips under the wall cabinets and in the ceiling."""
    add_sun(SUN[variant], 24.0, (1.0, 0.90, 0.75), 0.53)
    set_world((0.75, 0.88, 1.0))
    for x, y in PENDANTS:
        add_point((x, y, HEIGHT - 0.95), 14.0, WARM, 0.035)
    blend_file.add_lights(
        [
            AreaLight("RECTANGLE", (-0.1, BACK - 0.2, 1.49), (-0.1, BACK - 0.2, 0.9), 5.0, (0.75, 0.03), WARM),
            AreaLight("RECTANGLE", (1.16, BACK - 0.2, 1.49), (1.16, BACK - 0.2, 0.9), 3.0, (0.35, 0.03), WARM),
            AreaLight("DISK", (-0.9, 0.1, 2.58), (-0.9, 0.1, 0.0), 28.0, (0.3, 0.3), WHITE),
        ]
    )
