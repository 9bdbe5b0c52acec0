# SPDX-License-Identifier: GPL-3.0-or-later
"""The kitchen's fronts, appliances and furniture. Fronts lie in y = 0, face -y and begin at x = 0; in metres."""

import math
from itertools import pairwise

import numpy as np
from mathutils import Matrix

from tests.scenes.parts.shapes import Shape, box, grid, join, lathe, ring, rounded_profile
from tests.scenes.parts.solids import rounded_box, tube

from .product_shapes import FORWARD, POLE, Parts, disc_of, turned

UNIT = 0.6  # m, width of a cabinet


def front(width: float, height: float) -> Shape:
    """A door or drawer: a frame around a recessed panel, 2 cm thick, 2 mm smaller on each side."""
    edge, w, h = 0.07 if height > 0.3 else 0.035, width - 0.002, height - 0.002
    stiles = [
        rounded_box((x, -0.022, 0.002), (x + edge - 0.002, -0.002, h), 0.003, 1) for x in (0.002, w - edge + 0.002)
    ]
    # They reach into the stiles, and lie behind their faces: vertices at the same positions would be merged.
    rails = [
        rounded_box((edge - 0.005, -0.021, z), (w - edge + 0.005, -0.003, z + edge - 0.003), 0.003, 1)
        for z in (0.003, h - edge + 0.001)
    ]
    panel = box((edge - 0.01, -0.012, edge - 0.01), (w - edge + 0.01, -0.004, h - edge + 0.01))
    return join([panel, *stiles, *rails])


def handle(length: float, is_upright: bool) -> Shape:
    """A bar on two feet, its middle at the origin."""
    half = 0.5 * length
    bar = np.array([(-half, -0.03, 0.0), (0.0, -0.03, 0.0), (half, -0.03, 0.0)])
    feet = [np.array([(x, 0.0, 0.0), (x, -0.015, 0.0), (x, -0.03, 0.0)]) for x in (0.02 - half, half - 0.02)]
    shape = join([tube(bar, 0.006, 12), *(tube(foot, 0.0045, 8) for foot in feet)])
    return shape.transformed(Matrix.Rotation(0.5 * math.pi, 4, "Y")) if is_upright else shape


def base_unit(kind: str, color: str) -> Parts:
    """A cabinet under the counter: doors, drawers or an oven, on a plinth."""
    carcass = box((0.0, 0.0, 0.1), (UNIT, 0.57, 0.86))
    plinth = box((0.0, 0.05, 0.0), (UNIT, 0.55, 0.1))
    if kind == "doors":
        fronts = [front(0.5 * UNIT, 0.76).moved(x=x, z=0.1) for x in (0.0, 0.5 * UNIT)]
        handles = [handle(0.14, True).moved(x=0.5 * UNIT + side * 0.035, y=-0.022, z=0.72) for side in (-1.0, 1.0)]
    elif kind == "drawers":
        heights = 0.1, 0.4, 0.66, 0.86
        fronts = [front(UNIT, high - low).moved(z=low) for low, high in pairwise(heights)]
        handles = [handle(0.2, False).moved(x=0.5 * UNIT, y=-0.022, z=high - 0.07) for high in heights[1:]]
    else:
        return [(join([carcass, rounded_box((0.005, -0.02, 0.12), (0.595, 0.0, 0.85), 0.006, 2)]), "Oven enamel"),
                (rounded_box((0.06, -0.026, 0.2), (0.54, -0.018, 0.58), 0.003, 1), "Dark glass"),
                (join([handle(0.5, False).moved(x=0.3, y=-0.02, z=0.65), *knobs()]), "Hood steel"),
                (plinth, "Plinth")]  # fmt: skip
    return [(carcass, "White paint"), (join(fronts), color), (join(handles), "Handle brass"), (plinth, "Plinth")]


def knobs() -> list[Shape]:
    """The oven's five knobs."""
    knob = turned(
        (0.02, 0.0), (0.02, 0.006), (0.016, 0.008), (0.015, 0.026), (0.012, 0.028), (POLE, 0.028), segments=32
    )
    return [knob.transformed(Matrix.Translation((x, -0.02, 0.76)) @ FORWARD) for x in (0.1, 0.2, 0.3, 0.4, 0.5)]


def wall_unit(width: float, color: str) -> Parts:
    """A cabinet of two doors on the wall, 70 cm high and 34 cm deep."""
    half = 0.5 * width
    fronts = [front(half, 0.7).moved(x=x) for x in (0.0, half)]
    handles = [handle(0.14, True).moved(x=half + side * 0.035, y=-0.022, z=0.12) for side in (-1.0, 1.0)]
    return [(box((0.0, 0.0, 0.0), (width, 0.34, 0.7)), color), (join(fronts), color), (join(handles), "Handle brass")]


def fridge() -> Parts:
    """A fridge of the fifties with round edges, 68 cm wide, its left side at x = 0."""
    doors = [rounded_box((0.0, -0.06, low), (0.68, 0.0, high), 0.028, 5) for low, high in ((0.12, 1.25), (1.26, 1.9))]
    body = rounded_box((0.0, -0.01, 0.06), (0.68, 0.6, 1.91), 0.03, 4)
    handles = [handle(0.3, True).moved(x=0.07, y=-0.06, z=z) for z in (1.0, 1.42)]
    photo = print_of(0.23, 0.15).moved(0.44, -0.0615, 1.53)
    return [(join([*doors, body]), "Fridge enamel"), (join(handles), "Tap chrome"), (photo, "Photo")]


def print_of(width: float, height: float) -> Shape:
    """A rectangle around the origin that faces -y, its coordinates 0..1."""
    uvs = np.array([[(0.0, 0.0), (1.0, 0.0)], [(0.0, 1.0), (1.0, 1.0)]])
    x, z = width * (uvs[..., 0] - 0.5), height * (uvs[..., 1] - 0.5)
    return grid(np.stack([x, np.zeros_like(x), z], axis=-1), uvs)


def picture() -> Parts:
    """A framed print of 80 × 55 cm that faces -y."""
    profile = [(0.0, 0.0), (0.0, 0.02), (0.015, 0.03), (0.035, 0.02), (0.035, 0.0)]
    return [(ring(profile, 0.4, 0.275).transformed(FORWARD), "Walnut"), (print_of(0.8, 0.55).moved(y=-0.01), "Photo")]


def hood() -> Parts:
    """An extractor hood with a chimney, 60 cm wide, its lower edge at z = 0."""
    low, high = (
        ((-0.3, -0.48), (0.3, -0.48), (0.3, 0.0), (-0.3, 0.0)),
        ((-0.12, -0.24), (0.12, -0.24), (0.12, 0.0), (-0.12, 0.0)),
    )
    loops = [
        [(*corner, z) for corner in (*loop, loop[0])]
        for loop, z in ((low, 0.0), (low, 0.05), (high, 0.24), (high, 0.9))
    ]
    points = np.array(loops)
    return [(grid(points, points[..., [0, 2]]), "Hood steel")]


def hob() -> Parts:
    """A glass hob of 56 × 50 cm on the counter, with four iron rings."""
    rings = [lathe(np.array([(r - 0.012, 0.0), (r - 0.01, 0.012), (r, 0.012), (r, 0.0)]), 48) for r in (0.075, 0.1)]
    places = ((-0.14, -0.12, 0), (0.14, -0.12, 1), (-0.14, 0.12, 1), (0.14, 0.12, 0))
    return [(rounded_box((-0.28, -0.25, 0.0), (0.28, 0.25, 0.008), 0.003, 2), "Dark glass"),
            (join([rings[size].moved(x, y, 0.007) for x, y, size in places]), "Iron pan")]  # fmt: skip


def sink() -> Shape:
    """A bowl of 50 × 38 cm under a hole of the counter, 18 cm deep, with a rim on the counter."""
    loops = []
    for outwards, z in ((0.02, 0.0), (0.02, 0.004), (0.0, 0.004), (-0.004, -0.01), (-0.012, -0.16), (-0.05, -0.18)):
        loops.append(rounded_rectangle(0.25 + outwards, 0.19 + outwards, 0.05, z))
    loops.append(0.001 * loops[-1] + (0.0, 0.0, -0.182))
    points = np.stack(loops)
    return grid(points, points[..., :2] - points[..., 2:])


def rounded_rectangle(half_x: float, half_y: float, radius: float, z: float) -> np.ndarray:
    """(N,3): a closed loop at a height."""
    angles = np.concatenate([np.linspace(start, start + 0.5 * math.pi, 7) for start in 0.5 * math.pi * np.arange(4)])
    corner = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    quadrant = np.sign(np.stack([np.cos(np.repeat(np.arange(4) + 0.5, 7) * 0.5 * math.pi),
                                 np.sin(np.repeat(np.arange(4) + 0.5, 7) * 0.5 * math.pi)], axis=-1))  # fmt: skip
    loop = quadrant * (half_x - radius, half_y - radius) + radius * corner
    return np.column_stack([np.concatenate([loop, loop[:1]]), np.full(len(loop) + 1, z)])


def tap() -> Shape:
    """A swan-neck tap, 30 cm high, which reaches along x, with a lever."""
    t = np.linspace(0.0, math.pi, 20)
    neck = np.stack([0.08 - 0.08 * np.cos(t), np.zeros_like(t), 0.22 + 0.08 * np.sin(t)], axis=-1)
    spout = np.concatenate([[(0.0, 0.0, 0.0), (0.0, 0.0, 0.1)], neck, [(0.16, 0.0, 0.19)]])
    foot = turned((0.026, 0.0), (0.026, 0.01), (0.02, 0.012), (0.02, 0.06), (0.012, 0.065), segments=32)
    lever = tube(np.array([(0.0, 0.0, 0.045), (0.01, -0.03, 0.05), (0.03, -0.09, 0.06)]), 0.006, 10)
    return join([tube(spout, 0.011, 16), foot, lever])


def table() -> Shape:
    """A table of 1.4 × 0.8 m, 75 cm high."""
    legs = [box((x - 0.03, y - 0.03, 0.0), (x + 0.03, y + 0.03, 0.72)) for x in (-0.62, 0.62) for y in (-0.33, 0.33)]
    rails = [box((-0.62, y - 0.012, 0.63), (0.62, y + 0.012, 0.715)) for y in (-0.33, 0.33)]
    return join([rounded_box((-0.7, -0.4, 0.715), (0.7, 0.4, 0.75), 0.006, 2), *rails, *legs])


def chair() -> Parts:
    """A wooden chair with a cushion, its back towards +y."""
    wood = [rounded_box((-0.21, -0.21, 0.43), (0.21, 0.21, 0.45), 0.006, 2)]
    for x in (-0.18, 0.18):
        wood.append(tube(np.array([(1.1 * x, -0.2, 0.0), (x, -0.18, 0.2), (x, -0.18, 0.44)]), 0.016, 10))
        wood.append(tube(np.array([(1.1 * x, 0.23, 0.0), (x, 0.19, 0.44), (x, 0.2, 0.7), (x, 0.25, 0.9)]), 0.016, 10))
    for z, y in ((0.62, 0.205), (0.73, 0.212), (0.84, 0.235)):
        wood.append(rounded_box((-0.18, y - 0.008, z), (0.18, y + 0.008, z + 0.05), 0.005, 2))
    return [(join(wood), "Beech"), (rounded_box((-0.2, -0.2, 0.45), (0.2, 0.19, 0.485), 0.017, 4), "Tea towel")]


def pendant(drop: float) -> Parts:
    """A lamp shade below the origin on a cord of a length in m, open at its lower end."""
    profile = rounded_profile([(0.02, 0.0), (0.03, 0.0), (0.05, -0.02), (0.15, -0.1), (0.17, -0.16), (0.172, -0.18)])
    shade = lathe(np.concatenate([profile, profile[::-1] - (0.003, 0.0)]), 64).moved(z=-drop)
    cord = tube(np.array([(0.0, 0.0, 0.0), (0.0, 0.0, -0.5 * drop), (0.0, 0.0, -drop)]), 0.004, 8)
    return [(shade, "Lamp shade"), (cord, "Plinth")]


def clock() -> Parts:
    """A wall clock of 30 cm that faces -y. The coordinates of its face are those of `dial`."""
    face, uvs = disc_of(0.0167, 48)
    place = Matrix.Translation((0.0, -0.02, 0.0)) @ FORWARD
    rim = turned((0.152, -0.02), (0.16, 0.0), (0.155, 0.02), (0.148, 0.02), (0.146, 0.004), segments=64)
    return [
        (grid(face, uvs).transformed(place @ Matrix.Scale(9.0, 4)), "Clock"),
        (rim.transformed(place), "Tap chrome"),
    ]
