# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands and lies in the kitchen: pots, crockery, food, books. Each stands on z = 0; in metres."""

import math

import numpy as np
from mathutils import Matrix

from tests.scenes.parts.shapes import Shape, box, grid, join, lathe
from tests.scenes.parts.solids import ball, rounded_box, tube
from tests.scenes.thin import leaf

from . import product_shapes
from .product_shapes import POLE


def turned(*profile: tuple[float, float], segments: int = 40) -> Shape:
    """A profile of (radius, height), rotated about the z axis, of few triangles: there are many of these things."""
    return product_shapes.turned(*profile, segments=segments, rounds=2)


def pot(radius: float, height: float) -> Shape:
    """A pot with two handles and a lid."""
    r, h = radius, height
    body = turned(
        (POLE, 0.0), (0.9 * r, 0.0), (r, 0.0), (r, 0.02), (r, h - 0.01), (r, h), (1.04 * r, h), (1.04 * r, h + 0.004)
    )
    lid = turned(
        (1.02 * r, h + 0.004), (1.02 * r, h + 0.012), (0.6 * r, h + 0.03), (0.15 * r, h + 0.034), (POLE, h + 0.034)
    )
    knob = turned(
        (0.006, h + 0.03), (0.006, h + 0.045), (0.02, h + 0.05), (0.016, h + 0.062), (POLE, h + 0.062), segments=32
    )
    t = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 14)
    grips = []
    for side in (-1.0, 1.0):
        path = np.stack([side * (0.98 * r + 0.035 * np.cos(t)), 0.045 * np.sin(t), np.full_like(t, 0.8 * h)], axis=-1)
        grips.append(tube(path, 0.006, 10))
    return join([body, lid, knob, *grips])


def pan(radius: float) -> Shape:
    """A frying pan, its handle along -y."""
    r = radius
    body = turned(
        (POLE, 0.0),
        (0.8 * r, 0.0),
        (0.86 * r, 0.0),
        (r, 0.045),
        (r, 0.048),
        (0.97 * r, 0.045),
        (0.84 * r, 0.006),
        (POLE, 0.006),
    )
    grip = np.array([(0.0, -0.95 * r, 0.038), (0.0, -1.2 * r, 0.052), (0.0, -1.9 * r, 0.06), (0.0, -2.3 * r, 0.056)])
    return join([body, tube(grip, np.array([0.012, 0.009, 0.011, 0.013]), 12)])


def plate(radius: float = 0.13) -> Shape:
    """A plate."""
    r = radius
    return turned(
        *((POLE, 0.006), (0.5 * r, 0.003), (0.55 * r, 0.0), (0.6 * r, 0.0), (r, 0.02), (r, 0.023)),
        *((0.95 * r, 0.0215), (0.65 * r, 0.009), (POLE, 0.008)),
    )


def mug() -> Shape:
    """A mug, its handle along x."""
    body = turned(
        *((POLE, 0.003), (0.03, 0.0), (0.037, 0.0), (0.04, 0.01), (0.04, 0.09), (0.04, 0.095)),
        *((0.037, 0.095), (0.037, 0.09), (0.036, 0.01), (POLE, 0.008)),
        segments=32,
    )
    t = np.linspace(-0.45 * math.pi, 0.45 * math.pi, 16)
    return join([body, tube(np.stack([0.036 + 0.028 * np.cos(t), 0.0 * t, 0.05 + 0.028 * np.sin(t)], -1), 0.005, 10)])


def tumbler() -> Shape:
    """A tumbler."""
    return turned(
        *((POLE, 0.0), (0.026, 0.0), (0.03, 0.0), (0.032, 0.02), (0.038, 0.12), (0.0385, 0.124)),
        *((0.036, 0.122), (0.031, 0.02), (0.02, 0.008), (POLE, 0.008)),
        segments=32,
    )


def tin() -> Shape:
    """A tin with a lid, 12 cm high."""
    profile = [(POLE, 0.0), (0.042, 0.0), (0.043, 0.002), (0.043, 0.1), (0.0445, 0.101), (0.0445, 0.118), (0.042, 0.12)]
    return lathe(np.array([*profile, (POLE, 0.12)]), 40)


def bowl(radius: float) -> Shape:
    """A round bowl."""
    r = radius
    return turned(
        *((POLE, 0.004), (0.3 * r, 0.0), (0.4 * r, 0.0), (0.75 * r, 0.2 * r), (r, 0.52 * r), (r, 0.56 * r)),
        *((0.95 * r, 0.54 * r), (0.7 * r, 0.25 * r), (0.35 * r, 0.08 * r), (POLE, 0.06 * r)),
    )


def apple() -> Shape:
    """An apple, 8 cm wide, and its stalk."""
    body = turned(
        *((POLE, 0.012), (0.012, 0.0), (0.028, 0.004), (0.042, 0.035), (0.042, 0.062), (0.022, 0.082), (0.008, 0.07)),
        *((POLE, 0.064),),
    )
    return join([body, tube(np.array([(0.0, 0.0, 0.062), (0.002, 0.0, 0.078), (0.007, 0.0, 0.09)]), 0.0016, 6)])


def citrus(length: float) -> Shape:
    """A fruit of 7 cm across the x axis, pointed if it is longer than that."""
    sphere = ball(0.035, 14)
    positions = sphere.positions + (0.0, 0.0, 0.034)
    if length > 0.07:
        positions[:, 0] *= length / 0.07 * (1.0 + 0.12 * (positions[:, 0] / 0.035) ** 8)
    return Shape(positions, sphere.quads, sphere.uvs)


def loaf() -> Shape:
    """A loaf of bread of 28 cm along x, with cuts."""
    shape = ball(1.0, 24, 2.6)
    x, y, z = (shape.positions * (0.14, 0.06, 0.05)).T
    cut = np.abs((x * 18.0 + y * 4.0 + 0.5) % 1.0 - 0.5)
    z = z - 0.008 * np.exp(-((cut / 0.12) ** 2)) * (z > 0.02)
    return Shape(np.stack([x, y, np.maximum(z, -0.036) + 0.036], axis=-1), shape.quads, shape.uvs)


def knife() -> tuple[Shape, Shape]:
    """A kitchen knife along x: its blade and its grip."""
    edge = np.array([(0.0, -0.02), (0.12, -0.02), (0.165, -0.004), (0.18, 0.012)])
    back = np.array([(0.0, 0.012), (0.12, 0.0125), (0.165, 0.0122), (0.1801, 0.0121)])
    sides = [np.stack([np.column_stack([line, np.full(4, z)]) for line in (edge, back)]) for z in (0.004, 0.006)]
    blade = join([grid(side, side[..., :2]) for side in sides])
    return blade, rounded_box((-0.12, -0.012, 0.0), (0.0, 0.012, 0.016), 0.006, 3)


def basil(random: np.random.Generator) -> Shape:
    """Leaves of a pot plant, above the rim of a pot of 12 cm."""
    leaves = []
    for _ in range(110):
        height, angle, out = random.uniform(0.0, 0.16), random.uniform(0.0, 6.3), 0.07 * random.random() ** 0.5
        size = Matrix.Diagonal((0.9, 1.4, 0.9, 1.0))
        leaves.append(leaf(random).transformed(size).moved(out * math.cos(angle), out * math.sin(angle), 0.13 + height))
    return join(leaves)


def flower_pot() -> Shape:
    """A clay pot, 12 cm high, filled with soil."""
    return turned(
        *((POLE, 0.0), (0.04, 0.0), (0.045, 0.0), (0.058, 0.095), (0.064, 0.095), (0.066, 0.12)),
        *((0.06, 0.12), (0.058, 0.105), (POLE, 0.105)),
    )


def basket() -> Shape:
    """A round basket, 22 cm high."""
    return turned(
        *((POLE, 0.004), (0.13, 0.0), (0.15, 0.0), (0.18, 0.2), (0.185, 0.22), (0.17, 0.22), (0.14, 0.02)),
        *((POLE, 0.012),),
    )


def book(thickness: float) -> Shape:
    """A book that stands, its back towards -y."""
    return rounded_box((0.0, -0.08, 0.0), (thickness, 0.08, 0.23), 0.004, 2)


def towel() -> Shape:
    """A cloth that hangs in folds in y = 0, its upper edge at z = 0."""
    v, u = np.meshgrid(np.linspace(0.0, 1.0, 40), np.linspace(0.0, 1.0, 40), indexing="ij")
    y = (0.012 + 0.012 * v) * np.sin(14.0 * u + 2.0 * v)
    return grid(np.stack([0.36 * (u - 0.5), y, -0.5 * v], axis=-1), np.stack([0.42 * u, 0.5 * v], axis=-1))


def board() -> Shape:
    """A chopping board of 42 × 28 cm."""
    return rounded_box((-0.21, -0.14, 0.0), (0.21, 0.14, 0.03), 0.006, 3)


def shelf(length: float) -> Shape:
    """A board on the wall along x, 24 cm deep."""
    return join([rounded_box((0.0, -0.24, -0.03), (length, 0.0, 0.0), 0.004, 1),
                 *(box((x, -0.2, -0.12), (x + 0.02, 0.0, -0.03)) for x in (0.1, length - 0.12))])  # fmt: skip
