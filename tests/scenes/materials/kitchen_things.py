# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of what stands and hangs in the kitchen: pots, crockery, food, cloths."""

from collections.abc import Callable

import bpy
import numpy as np

from tests.scenes.parts.textures import damask, mix, noise, pixels

from .graph import Color, Graph
from .kitchen_surfaces import enamel, paint, wood
from .product_materials import dial_image, stoneware


def hammered(name: str) -> bpy.types.Material:
    """Copper with the marks of a hammer in a normal map, tarnished in places."""
    size = 256
    x, y = pixels(size)
    random = np.random.default_rng(71)
    depth = np.full((size, size), np.inf)
    for px, py in random.random((90, 2)):
        dx, dy = (np.abs(each) for each in (x - px, y - py))
        depth = np.minimum(depth, np.hypot(np.minimum(dx, 1.0 - dx), np.minimum(dy, 1.0 - dy)))
    graph = Graph(name)
    normal = graph.normal_map(40.0 * depth, graph.coordinates(9.0), 0.35)
    tarnish = graph.noise(graph.coordinates(12.0, "Object"), 1.0, 5.0)
    base = graph.ramp(tarnish, (0.35, (0.86, 0.45, 0.30)), (0.75, (0.45, 0.20, 0.13)))
    return graph.surface(base, graph.range(tarnish, 0.08, 0.35), metallic=1.0, normal=normal)


def cast_iron(name: str) -> bpy.types.Material:
    """Rough, greasy black iron."""
    graph = Graph(name)
    at = graph.coordinates(source="Object")
    grains, grease = graph.noise(at, 350.0, 3.0), graph.noise(at, 9.0, 3.0)
    return graph.surface((0.035, 0.033, 0.032), graph.range(grease, 0.25, 0.6), normal=graph.bump(grains, 0.0006))


def speckled(name: str) -> bpy.types.Material:
    """Red enamel with white specks under a clear coat."""
    graph = Graph(name)
    specks = graph.mask(graph.noise(graph.coordinates(source="Object"), 260.0, 1.0), 0.68, 0.72)
    base = graph.mix(specks, (0.50, 0.025, 0.02), (0.75, 0.70, 0.65))
    return graph.surface(base, 0.3, coat_weight=1.0, coat_roughness=0.06)


def banded(name: str, ground: Color, ink: Color, scale: float, roughness: float) -> bpy.types.Material:
    """Glaze with bands around the z axis, uneven from the brush."""
    graph = Graph(name)
    wave = graph.add(
        "TexWave",
        {"Vector": graph.coordinates(source="Object"), "Scale": scale, "Distortion": 0.6, "Detail": 1.0},
        bands_direction="Z",
    )
    return graph.surface(graph.ramp(wave, (0.55, ground), (0.62, ink)), roughness)


def plate(name: str) -> bpy.types.Material:
    """White porcelain; an image colours the rim of a plate of 26 cm, from above."""
    size = 512
    x, y = (2.0 * each - 1.0 for each in pixels(size))
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    petals = (np.abs(radius - 0.84) < 0.07 * np.abs(np.cos(12.0 * angle))) | (np.abs(radius - 0.95) < 0.012)
    color = mix((0.93, 0.92, 0.89), (0.14, 0.32, 0.52), petals.astype(float))
    graph = Graph(name)
    at = graph.coordinates(1.0 / 0.26, "Object")
    at.inputs["Location"].default_value = (0.5, 0.5, 0.0)
    return graph.surface(graph.image(color, at), 0.12)


def plastic(name: str, color: Color) -> bpy.types.Material:
    """A ribbed tumbler of opaque plastic: a gradient up its side, and ribs as a bump."""
    graph = Graph(name)
    at = graph.coordinates(source="Object")
    height = graph.add("SeparateXYZ", {"Vector": at}).outputs["Z"]
    base = graph.ramp(graph.mask(height, 0.0, 0.12), (0.0, tuple(0.5 * each for each in color)), (1.0, color))
    ribs = graph.add("TexWave", {"Vector": at, "Scale": 22.0}, bands_direction="Z", wave_profile="SIN")
    return graph.surface(base, 0.15, normal=graph.bump(ribs, 0.001))


def tin(name: str) -> bpy.types.Material:
    """Printed tins, each with bands in one of five colours, and bare metal at the ends."""
    graph = Graph(name)
    at = graph.coordinates(source="Object")
    random = graph.add("ObjectInfo", {}).outputs["Random"]
    colors = ((0.55, 0.08, 0.05), (0.75, 0.5, 0.08), (0.08, 0.25, 0.18), (0.10, 0.18, 0.42), (0.55, 0.45, 0.35))
    printed = graph.ramp(
        random, *((0.2 * index, color) for index, color in enumerate(colors)), interpolation="CONSTANT"
    )
    height = graph.add("SeparateXYZ", {"Vector": at}).outputs["Z"]
    bands = graph.ramp(
        graph.mask(height, 0.0, 0.1),
        *((0.0, (0.0, 0.0, 0.0)), (0.3, (1.0, 1.0, 1.0)), (0.7, (0.0, 0.0, 0.0))),
        interpolation="CONSTANT",
    )
    checker = graph.add(
        "TexChecker", {"Vector": graph.coordinates(90.0), "Color1": (0.85, 0.8, 0.68), "Color2": printed}
    )
    base = graph.mix(bands, printed, graph.mix(0.7, (0.85, 0.8, 0.68), checker))
    is_metal = graph.add("Math", {0: height, 1: 0.1}, operation="GREATER_THAN")
    return graph.surface(graph.mix(is_metal, base, (0.6, 0.6, 0.6)), 0.25, metallic=is_metal)


def chopping_board(name: str) -> bpy.types.Material:
    """End grain: blocks of 4 cm, each with rings of its own."""
    graph = Graph(name)
    at = graph.coordinates()
    blocks = graph.add(
        "TexBrick",
        {
            "Vector": at, "Color1": (0.30, 0.16, 0.075), "Color2": (0.62, 0.42, 0.24), "Mortar": (0.10, 0.05, 0.03),
            "Scale": 1.0, "Mortar Size": 0.0006, "Brick Width": 0.05, "Row Height": 0.04,
        },
    )  # fmt: skip
    rings = graph.noise(
        graph.mix(0.9, at, graph.add("VectorMath", {"Vector": at, "Scale": 80.0}, operation="SCALE")), 1.0
    )
    shade = graph.ramp(rings, (0.2, (0.7, 0.65, 0.6)), (0.8, (1.1, 1.1, 1.1)))
    return graph.surface(graph.mix(1.0, blocks, shade, "MULTIPLY"), 0.5)


def crust(name: str) -> bpy.types.Material:
    """Bread: dark where it rises, floury in the hollows."""
    graph = Graph(name)
    at = graph.solid()
    lumps, flour = graph.noise(at, 25.0, 5.0), graph.noise(at, 12.0, 6.0, 0.7)
    base = graph.ramp(lumps, (0.3, (0.55, 0.33, 0.15)), (0.55, (0.34, 0.15, 0.05)), (0.8, (0.15, 0.06, 0.025)))
    return graph.surface(
        graph.mix(graph.mask(flour, 0.52, 0.75), base, (0.75, 0.68, 0.56)), 0.6, normal=graph.bump(lumps, 0.008)
    )


def apple(name: str) -> bpy.types.Material:
    """Red over yellow-green in streaks, with pale dots and a waxy gloss."""
    graph = Graph(name)
    streaks = graph.noise(graph.solid((30.0, 30.0, 6.0)), 1.0, 4.0)
    base = graph.ramp(streaks, (0.32, (0.50, 0.42, 0.07)), (0.5, (0.50, 0.06, 0.025)), (0.75, (0.28, 0.012, 0.012)))
    dots = graph.mask(graph.add("TexVoronoi", {"Vector": graph.solid(110.0), "Scale": 1.0}).outputs[0], 0.16, 0.10)
    return graph.surface(graph.mix(dots, base, (0.7, 0.5, 0.25)), 0.25)


def peel(name: str, color: Color, pale: Color) -> bpy.types.Material:
    """The pitted peel of oranges and lemons."""
    graph = Graph(name)
    pits = graph.add("TexVoronoi", {"Vector": graph.solid(230.0), "Scale": 1.0}, feature="SMOOTH_F1").outputs[0]
    base = graph.mix(graph.mask(graph.noise(graph.solid(20.0), 1.0), 0.3, 0.8), color, pale)
    return graph.surface(base, 0.35, normal=graph.bump(pits, 0.0015))


def gingham(name: str, color: Color) -> bpy.types.Material:
    """A cloth of woven checks of 3 cm, in sRGB, with its threads in a normal map."""
    size = 256
    x, y = pixels(size)
    stripes = (x < 0.5).astype(float) + (y < 0.5).astype(float)
    threads = np.sin(2.0 * np.pi * 32.0 * x) * np.sin(2.0 * np.pi * 32.0 * y)
    graph = Graph(name)
    at = graph.coordinates(1.0 / 0.06)
    image = graph.image(mix((0.93, 0.91, 0.86), color, 0.5 * stripes), at)
    return graph.surface(image, 0.9, normal=graph.normal_map(0.6 * threads, at))


def rug(name: str) -> bpy.types.Material:
    """A woven carpet with an oriental pattern."""
    graph = Graph(name)
    image = graph.image(damask((0.42, 0.12, 0.10), (0.80, 0.66, 0.42)), graph.coordinates(2.2))
    pile = graph.noise(graph.coordinates(), 500.0, 1.0)
    return graph.surface(image, 0.95, normal=graph.bump(pile, 0.003))


def wicker(name: str) -> bpy.types.Material:
    """A basket: a checker of horizontal and vertical strands, raised in a normal map."""
    size = 256
    x, y = pixels(size)
    is_over = ((x * 8.0).astype(int) + (y * 8.0).astype(int)) % 2 == 0
    strand = np.where(is_over, np.sin(np.pi * 8.0 * y % np.pi), np.sin(np.pi * 8.0 * x % np.pi))
    graph = Graph(name)
    at = graph.coordinates(9.0)
    tone = 0.2 + 0.7 * strand + 0.1 * noise(size, 1.0, 81)
    image = graph.image(mix((0.30, 0.18, 0.09), (0.74, 0.56, 0.34), tone), at)
    return graph.surface(image, 0.6, normal=graph.normal_map(7.0 * strand, at))


def clock(name: str) -> bpy.types.Material:
    """A clock's face in 4 × 4 cm, see `dial`."""
    graph = Graph(name)
    return graph.surface(graph.image(dial_image((0.95, 0.94, 0.90), (0.08, 0.08, 0.09)), graph.coordinates(25.0)), 0.3)


def herb(name: str) -> bpy.types.Material:
    """Basil leaves, paler along the middle."""
    graph = Graph(name)
    across = graph.add("SeparateXYZ", {"Vector": graph.coordinates()}).outputs["Y"]
    middle = graph.mask(graph.add("Math", {0: across}, operation="ABSOLUTE"), 0.002, 0.0)
    green = graph.ramp(graph.noise(graph.solid(18.0), 1.0), (0.3, (0.05, 0.16, 0.02)), (0.7, (0.13, 0.30, 0.05)))
    return graph.surface(graph.mix(middle, green, (0.25, 0.40, 0.12)), 0.35)


def book(name: str) -> bpy.types.Material:
    """Cloth covers: each book has another colour."""
    graph = Graph(name)
    hue = graph.add("HueSaturation", {"Color": (0.42, 0.10, 0.07)})
    graph.set_inputs(hue, {"Hue": graph.add("ObjectInfo", {}).outputs["Random"]})
    weave = graph.add("TexMagic", {"Vector": graph.coordinates(300.0), "Scale": 1.0}, turbulence_depth=2)
    return graph.surface(hue, 0.6, normal=graph.bump(weave.outputs["Fac"], 0.0005))


#: By name; each is made at its first use.
THINGS: dict[str, Callable[[str], bpy.types.Material]] = {
    "Copper": hammered,
    "Iron pan": cast_iron,
    "Speckled enamel": speckled,
    "Striped glaze": lambda name: banded(name, (0.78, 0.75, 0.68), (0.07, 0.20, 0.38), 9.0, 0.15),
    "Brown glaze": lambda name: banded(name, (0.20, 0.09, 0.04), (0.55, 0.38, 0.20), 6.0, 0.2),
    "Clay cup": stoneware,
    "Plate": plate,
    "Green plastic": lambda name: plastic(name, (0.10, 0.48, 0.20)),
    "Blue plastic": lambda name: plastic(name, (0.06, 0.22, 0.60)),
    "Tin": tin,
    "Chopping board": chopping_board,
    "Olive wood": lambda name: wood(name, (0.20, 0.11, 0.05), (0.55, 0.36, 0.18), 0.35, 30.0),
    "Crust": crust,
    "Apple": apple,
    "Orange": lambda name: peel(name, (0.78, 0.24, 0.02), (0.80, 0.36, 0.04)),
    "Lemon": lambda name: peel(name, (0.80, 0.60, 0.05), (0.66, 0.62, 0.10)),
    "Gingham": lambda name: gingham(name, (0.62, 0.12, 0.12)),
    "Tea towel": lambda name: gingham(name, (0.13, 0.28, 0.46)),
    "Carpet": rug,
    "Wicker": wicker,
    "Clock": clock,
    "Flower pot": lambda name: paint(name, (0.45, 0.17, 0.085), 0.8, 0.004),
    "Basil": herb,
    "Lamp shade": lambda name: enamel(name, (0.68, 0.38, 0.05), 0.2),
    "Book": book,
}
