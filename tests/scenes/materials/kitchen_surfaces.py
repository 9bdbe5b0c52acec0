# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of the kitchen's room, cabinets and appliances."""

from collections.abc import Callable

import bpy
import numpy as np

from tests.scenes.parts.textures import mix, noise, pixels

from .graph import Color, Graph, plain


def paint(name: str, color: Color, roughness: float, texture: float = 0.0005) -> bpy.types.Material:
    """A coat of paint from a roller: faint clouds, and bumps of a height in m."""
    graph = Graph(name)
    at = graph.coordinates(source="Object")
    dark, light = (tuple(factor * each for each in color) for factor in (0.93, 1.05))
    base = graph.ramp(graph.noise(at, 3.0), (0.3, dark), (0.7, light))
    return graph.surface(base, roughness, normal=graph.bump(graph.noise(at, 160.0, 2.0), texture))


def wood(
    name: str, dark: Color, light: Color, roughness: float, across: float = 14.0, axis: int = 0
) -> bpy.types.Material:
    """Wood whose fibres run along an axis of the object: a distorted wave and fine pores."""
    graph = Graph(name)
    stretch = np.where(np.arange(3) == axis, 1.0 / across, 1.0)
    at = graph.solid(tuple(across * stretch))
    wave = graph.add(
        "TexWave",
        {"Vector": at, "Scale": 0.5, "Distortion": 3.5, "Detail": 3.0, "Detail Scale": 1.4},
        wave_profile="SAW",
        bands_direction="DIAGONAL",
    )
    pores = graph.noise(graph.solid(tuple(400.0 * stretch)), 1.0, 2.0)
    grain = graph.mix(0.25, wave, pores)
    base = graph.ramp(grain, (0.1, dark), (0.85, light))
    return graph.surface(base, graph.range(pores, roughness, roughness + 0.15), normal=graph.bump(grain, 0.0006))


def brushed(name: str, color: Color, low: float, high: float, scale: Color) -> bpy.types.Material:
    """Metal with scratches; their size along each axis of the object is 1 / `scale` in m."""
    graph = Graph(name)
    scratches = graph.noise(graph.coordinates(scale, "Object"), 1.0, 4.0)
    dirt = graph.noise(graph.coordinates(source="Object"), 5.0)
    smears = graph.range(dirt, -0.05, 0.1)
    roughness = graph.add("Math", {0: graph.range(scratches, low, high), 1: smears}, operation="ADD")
    return graph.surface(color, roughness, metallic=1.0, normal=graph.bump(scratches, 0.0001))


def floor(name: str) -> bpy.types.Material:
    """Boards of 12 cm × 1.1 m: a brick texture with the grain of an image, oiled unevenly."""
    size = 512
    _, y = pixels(size)
    streaks = np.repeat(noise(size, 0.9, 61)[:, :1], size, axis=1)
    grain = np.sin(2.0 * np.pi * (9.0 * y + 0.25 * noise(size, 1.6, 62)))
    color = mix((0.44, 0.31, 0.20), (0.66, 0.50, 0.34), 0.5 + 0.15 * streaks + 0.2 * grain)
    graph = Graph(name)
    at = graph.coordinates()
    image = graph.image(color, graph.coordinates((0.8, 2.1, 1.0)))
    boards = graph.add(
        "TexBrick",
        {
            "Vector": at, "Color1": (0.75, 0.72, 0.70), "Color2": (1.15, 1.1, 1.05), "Mortar": (0.12, 0.09, 0.07),
            "Scale": 1.0, "Mortar Size": 0.0015, "Brick Width": 1.1, "Row Height": 0.12, "Bias": -0.1,
        },
        offset=0.37,
    )  # fmt: skip
    roughness = graph.range(graph.noise(at, 2.5, 4.0), 0.25, 0.5)
    normal = graph.bump(boards.outputs["Fac"], -0.002)
    return graph.surface(graph.mix(1.0, image, boards, "MULTIPLY"), roughness, normal=normal)


def tiles(name: str) -> bpy.types.Material:
    """Glazed tiles of 15 × 7.5 cm in two whites with a wavy glaze."""
    graph = Graph(name)
    at = graph.coordinates()
    tone = graph.noise(at, 9.0)
    bricks = graph.add(
        "TexBrick",
        {
            "Vector": at, "Color1": graph.mix(tone, (0.66, 0.72, 0.68), (0.78, 0.82, 0.78)),
            "Color2": (0.74, 0.78, 0.74), "Mortar": (0.42, 0.40, 0.37), "Scale": 1.0, "Mortar Size": 0.0025,
            "Mortar Smooth": 0.2, "Brick Width": 0.15, "Row Height": 0.075,
        },
    )  # fmt: skip
    joint = bricks.outputs["Fac"]
    waves = graph.bump(graph.noise(at, 14.0, 1.0), 0.004)
    normal = graph.add("Bump", {"Height": joint, "Distance": -0.003, "Normal": waves})
    return graph.surface(bricks, graph.range(joint, 0.12, 0.8), normal=normal)


def granite(name: str) -> bpy.types.Material:
    """Polished dark stone: crystals of a Voronoi texture."""
    graph = Graph(name)
    at = graph.coordinates(source="Object")
    crystals = graph.add("TexVoronoi", {"Vector": at, "Scale": 130.0}).outputs["Color"]
    value = graph.add("SeparateColor", {"Color": crystals}).outputs["Red"]
    base = graph.ramp(
        value,
        (0.0, (0.03, 0.03, 0.035)),
        (0.55, (0.09, 0.09, 0.10)),
        (0.8, (0.24, 0.22, 0.21)),
        (1.0, (0.5, 0.47, 0.44)),
    )
    clouds = graph.noise(at, 4.0, 5.0)
    return graph.surface(graph.mix(graph.mask(clouds, 0.3, 0.9), base, (0.10, 0.085, 0.08)), 0.15)


def marble(name: str) -> bpy.types.Material:
    """White stone with grey veins where noise is near its middle."""
    graph = Graph(name)
    at = graph.coordinates(source="Object")
    field = graph.add("TexNoise", {"Vector": at, "Scale": 4.0, "Detail": 6.0, "Distortion": 1.2})
    ground = 0.74, 0.73, 0.71
    base = graph.ramp(field, (0.44, ground), (0.50, (0.36, 0.36, 0.38)), (0.56, ground))
    return graph.surface(base, 0.2)


def photo(name: str) -> bpy.types.Material:
    """A print of hills under an evening sky, 0..1 in both coordinates."""
    size = 256
    x, y = pixels(size)
    color = mix((0.95, 0.62, 0.35), (0.30, 0.45, 0.75), y)
    for height, tone in ((0.5, (0.42, 0.45, 0.50)), (0.36, (0.25, 0.34, 0.30)), (0.2, (0.12, 0.2, 0.12))):
        ridge = height + 0.05 * noise(size, 1.8, int(100 * height))[0]
        color = np.where((y < ridge)[..., None], tone, color)
    edge = np.minimum(np.minimum(x, 1.0 - x), np.minimum(y, 1.0 - y)) < 0.05
    color = mix(color, (0.95, 0.95, 0.93), edge.astype(float))
    graph = Graph(name)
    return graph.surface(graph.image(color, graph.coordinates()), 0.25)


def enamel(name: str, color: Color, roughness: float) -> bpy.types.Material:
    """Smooth enamel on sheet metal that is not quite flat, with smears."""
    graph = Graph(name)
    at = graph.coordinates(source="Object")
    smears = graph.noise(graph.coordinates((6.0, 6.0, 1.5), "Object"), 1.0, 4.0)
    return graph.surface(
        graph.mix(graph.mask(smears, 0.5, 0.9), color, tuple(0.85 * each for each in color)),
        graph.range(smears, roughness, roughness + 0.12),
        normal=graph.bump(graph.noise(at, 2.5, 1.0), 0.004),
    )


#: By name; each is made at its first use.
SURFACES: dict[str, Callable[[str], bpy.types.Material]] = {
    "Wall paint": lambda name: paint(name, (0.68, 0.62, 0.50), 0.75, 0.001),
    "Ceiling paint": lambda name: paint(name, (0.76, 0.75, 0.72), 0.9, 0.001),
    "Cabinet paint": lambda name: paint(name, (0.085, 0.20, 0.22), 0.3),
    "White paint": lambda name: paint(name, (0.74, 0.73, 0.70), 0.35),
    "Plinth": lambda name: paint(name, (0.03, 0.03, 0.03), 0.5),
    "Floor boards": floor,
    "Wall tiles": tiles,
    "Granite": granite,
    "Veined marble": marble,
    "Oak front": lambda name: wood(name, (0.33, 0.19, 0.09), (0.60, 0.41, 0.23), 0.35, axis=2),
    "Walnut": lambda name: wood(name, (0.10, 0.045, 0.022), (0.30, 0.16, 0.085), 0.25, 9.0),
    "Beech": lambda name: wood(name, (0.48, 0.29, 0.16), (0.68, 0.48, 0.30), 0.4, 22.0),
    "Fridge enamel": lambda name: enamel(name, (0.62, 0.50, 0.30), 0.15),
    "Oven enamel": lambda name: enamel(name, (0.035, 0.035, 0.04), 0.2),
    "Hood steel": lambda name: brushed(name, (0.58, 0.58, 0.59), 0.25, 0.4, (3.0, 3.0, 700.0)),
    "Sink steel": lambda name: brushed(name, (0.62, 0.63, 0.64), 0.15, 0.35, (500.0, 4.0, 4.0)),
    "Handle brass": lambda name: brushed(name, (0.78, 0.56, 0.24), 0.15, 0.3, (40.0, 400.0, 400.0)),
    "Tap chrome": lambda name: plain(name, (0.80, 0.81, 0.82), 0.06, metallic=1.0),
    "Dark glass": lambda name: plain(name, (0.012, 0.012, 0.014), 0.1),
    "Photo": photo,
}
