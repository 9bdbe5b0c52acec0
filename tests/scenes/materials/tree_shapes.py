# SPDX-License-Identifier: GPL-3.0-or-later
"""A tree that grows at random, twigs of leaf cards, a bench and a picket fence. In metres."""

import math
from dataclasses import dataclass

import numpy as np
from mathutils import Matrix, Vector

from tests.scenes.parts.shapes import Shape, box, grid, join
from tests.scenes.parts.solids import rounded_box, tube

LEAVES = 24  # of a twig
TWIG = 0.32  # m, its length


@dataclass(frozen=True)
class Tree:
    """Trunk and boughs as a shape, and where twigs grow: matrices from the twig's space, in which it grows along x."""

    wood: Shape
    twigs: list[Matrix]


def grow(random: np.random.Generator, height: float, boughs: int, twigs: int) -> Tree:
    """A tree with a trunk of 0.4 of the height, boughs around it, branches on them, and twigs on the branches."""
    t = np.linspace(0.0, 1.0, 14)
    bend = random.uniform(-0.06, 0.06, (2, 2)) * height
    trunk = np.stack([bend[0, 0] * t**2 + 0.06 * np.sin(5.0 * t), bend[0, 1] * t**2, 0.8 * height * t - 0.1], axis=-1)
    flare = 0.028 * height * (1.0 - 0.85 * t + 0.9 * np.exp(-t / 0.035))
    wood, branches = [tube(trunk, flare, 20)], []
    for index in range(boughs):
        up = (index + random.random()) / boughs
        angle = 2.4 * index + random.uniform(-0.4, 0.4)
        # Boughs in the middle are the longest: the crown is an egg.
        length = height * (0.2 + 0.26 * math.sin(math.pi * (0.2 + 0.7 * up)))
        rise = 0.35 + 1.5 * up
        foot = trunk[4 + int(9.99 * up * 0.95)]
        bough = arm(random, foot, (math.cos(angle), math.sin(angle), rise), length, 12)
        wood.append(tube(bough, 0.011 * height * (1.0 - 0.8 * np.linspace(0.0, 1.0, 12)) * (1.1 - 0.5 * up), 10))
        branches.append(bough[5:])
        for _ in range(15):
            start = random.integers(3, 12)
            along = bough[start] - bough[start - 1]
            direction = along / np.linalg.norm(along) + random.normal(0.0, 0.8, 3)
            branch = arm(random, bough[start], direction, length * random.uniform(0.3, 0.6), 8)
            wood.append(tube(branch, 0.0035 * height * (1.0 - 0.8 * np.linspace(0.0, 1.0, 8)), 5))
            branches.append(branch[2:])
    matrices = []
    for index in range(twigs):
        branch = branches[index % len(branches)]
        at = random.uniform(0.0, len(branch) - 1.001)
        step = int(at)
        position = branch[step] + (at - step) * (branch[step + 1] - branch[step])
        along = (branch[step + 1] - branch[step]) / np.linalg.norm(branch[step + 1] - branch[step])
        direction = Vector(0.6 * along + random.normal(0.0, 0.6, 3) + (0.0, 0.0, 0.1))
        turn = direction.to_track_quat("X", "Z").to_matrix().to_4x4()
        roll = Matrix.Rotation(random.uniform(-0.6, 0.6), 4, "X")
        matrices.append(Matrix.Translation(position) @ turn @ roll @ Matrix.Scale(random.uniform(0.7, 1.2), 4))
    return Tree(join(wood), matrices)


def arm(random: np.random.Generator, foot: np.ndarray, direction: object, length: float, steps: int) -> np.ndarray:
    """A crooked path (steps,3) from a foot, which turns upwards at its end."""
    t = np.linspace(0.0, 1.0, steps)[:, None]
    unit = np.asarray(direction, float) / np.linalg.norm(direction)
    crook = np.cumsum(random.normal(0.0, 0.09, (steps, 3)), axis=0) * t
    return foot + length * (t * unit + 0.15 * t**2 * (0.0, 0.0, 1.0) + 0.3 * crook)


def twig(random: np.random.Generator) -> tuple[Shape, Shape]:
    """A twig along x: its stem, and its leaves, each a card of two triangles."""
    t = np.linspace(0.0, 1.0, 3)
    stem = np.stack([TWIG * t, 0.03 * np.sin(4.0 * t), 0.05 * t * (1.0 - t)], axis=-1)
    cards = []
    square = np.array([[(-0.5, 0.0), (0.5, 0.0)], [(-0.5, 1.0), (0.5, 1.0)]])
    for index in range(LEAVES):
        at = (index + 1.0) / LEAVES
        side = 1.0 if index % 2 else -1.0
        angle = side * random.uniform(0.5, 1.3) * (1.0 - 0.8 * at**6)
        length, width = random.uniform(0.065, 0.095) * np.array([1.0, 0.68])
        droop, roll = random.uniform(-0.9, 0.2), random.uniform(-0.7, 0.7)
        along = np.array([math.cos(angle), math.sin(angle), math.sin(droop)])
        along /= np.linalg.norm(along)
        flat = np.cross((0.0, 0.0, 1.0), along) / math.hypot(along[0], along[1])
        across = math.cos(roll) * flat + math.sin(roll) * np.cross(along, flat)
        foot = [np.interp(at, t, stem[:, axis]) for axis in range(3)]
        corners = foot + width * square[..., :1] * across + length * square[..., 1:] * along
        cards.append(grid(corners, square + (0.5, 0.0)))
    return tube(stem, 0.003 * (1.0 - 0.6 * t), 3), join(cards)


def bench() -> tuple[Shape, Shape]:
    """A garden bench along x, 1.6 m wide: its slats, and its two cast sides."""
    slats = [rounded_box((-0.8, y, 0.43), (0.8, y + 0.07, 0.46), 0.008, 2) for y in (-0.22, -0.13, -0.04, 0.05, 0.14)]
    lean = Matrix.Translation((0.0, 0.22, 0.0)) @ Matrix.Rotation(-0.2, 4, "X")
    slats += [
        rounded_box((-0.8, -0.015, z), (0.8, 0.015, z + 0.08), 0.008, 2).transformed(lean) for z in (0.55, 0.66, 0.77)
    ]
    sides = []
    for x in (-0.66, 0.66):
        for path in (
            ((-0.2, 0.0), (-0.21, 0.2), (-0.2, 0.42), (-0.19, 0.62), (-0.05, 0.66), (0.12, 0.63), (0.28, 0.64)),
            ((0.3, 0.0), (0.21, 0.22), (0.2, 0.42), (0.27, 0.6), (0.37, 0.88)),
            ((-0.22, 0.42), (0.0, 0.41), (0.22, 0.42)),
            ((-0.2, 0.12), (0.0, 0.28), (0.24, 0.12)),
        ):
            sides.append(tube(np.array([(x, y, z) for y, z in path]), 0.022, 10))
    return join(slats), join(sides)


def fence(pickets: int) -> Shape:
    """A picket fence along x from the origin, a picket every 14 cm, 0.95 m high."""
    parts = []
    for x in 0.14 * np.arange(pickets):
        outline = np.array([(x, 0.06), (x, 0.88), (x + 0.045, 0.95), (x + 0.09, 0.88), (x + 0.09, 0.06), (x, 0.06)])
        front = np.stack([outline[:, 0], np.full(len(outline), -0.012), outline[:, 1]], axis=-1)
        back = front + (0.0, 0.024, 0.0)
        middle = np.broadcast_to((x + 0.045, 0.5), outline.shape)
        for face in (front, back):
            centre = np.stack([middle[:, 0], face[:, 1], middle[:, 1]], axis=-1)
            parts.append(grid(np.stack([face, 0.999 * centre + 0.001 * face]), np.stack([outline, middle])))
        parts.append(grid(np.stack([front, back]), np.stack([outline, outline])))
    length = 0.14 * pickets
    parts += [box((-0.02, 0.012, z), (length, 0.045, z + 0.07)) for z in (0.22, 0.68)]
    parts += [box((x, 0.045, -0.1), (x + 0.09, 0.13, 1.0)) for x in np.arange(0.0, length, 1.68)]
    return join(parts)
