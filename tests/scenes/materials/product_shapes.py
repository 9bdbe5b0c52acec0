# SPDX-License-Identifier: GPL-3.0-or-later
"""The products, each as shapes with the names of their materials. They stand on z = 0; a camera looks along -y."""

import math

import numpy as np
from mathutils import Matrix

from tests.scenes.parts.shapes import Shape, box, grid, join, lathe, rounded_profile
from tests.scenes.parts.solids import ball, knot, rounded_box, tube

Parts = list[tuple[Shape, str]]

POLE = 3e-4  # m, radius of the hole at a cap's axis: a smaller one would be welded to degenerate quads
FORWARD = Matrix.Rotation(0.5 * math.pi, 4, "X")  # from the z axis to -y


def turned(*profile: tuple[float, float], segments: int = 72, rounds: int = 3) -> Shape:
    """A profile of (radius, height), smoothed in some rounds and rotated about the z axis."""
    return lathe(rounded_profile(profile, rounds), segments)


def bottle() -> Parts:
    """A wine bottle, 31 cm high."""
    glass = turned(
        *((POLE, 0.006), (0.032, 0.002), (0.041, 0.0), (0.041, 0.012), (0.041, 0.19), (0.041, 0.215)),
        *((0.014, 0.225), (0.0145, 0.27), (0.0145, 0.3)),
    )
    foil = turned((0.0149, 0.235), (0.0152, 0.3), (0.0152, 0.31), (0.0148, 0.311), (POLE, 0.311), segments=48)
    band = lathe(np.array([(0.0413, 0.045), (0.0413, 0.17)]), 72)
    return [(glass, "Bottle glass"), (foil, "Foil"), (band, "Label")]


def vase() -> Parts:
    """A porcelain vase, 22 cm high."""
    body = turned(
        *((POLE, 0.004), (0.03, 0.0), (0.032, 0.0), (0.034, 0.02), (0.075, 0.11), (0.05, 0.17), (0.012, 0.18)),
        *((0.024, 0.225), (0.03, 0.222), (0.026, 0.215), (0.01, 0.18), (0.01, 0.15), (POLE, 0.15)),
    )
    return [(body, "Porcelain")]


def can() -> Parts:
    """A brushed tin, 13 cm high, with rims and a lid with a knob."""
    side = lathe(np.array([(0.036, 0.004), (0.036, 0.108)]), 96)
    rims = [turned((0.035, z), (0.0372, z), (0.0372, z + 0.006), (0.035, z + 0.006), segments=96) for z in (0.0, 0.106)]
    lid = turned((0.0372, 0.113), (0.0372, 0.122), (0.036, 0.123), (0.01, 0.124), (POLE, 0.124), segments=96)
    knob = turned((0.004, 0.122), (0.004, 0.129), (0.011, 0.131), (0.009, 0.139), (POLE, 0.139), segments=48)
    return [(side, "Brushed aluminium"), (join(rims), "Steel"), (lid, "Satin steel"), (knob, "Chrome")]


def cup() -> Parts:
    """A stoneware cup, 9 cm high, with a handle."""
    body = turned(
        *((POLE, 0.003), (0.024, 0.0), (0.03, 0.0), (0.033, 0.012), (0.04, 0.05), (0.038, 0.092), (0.036, 0.094)),
        *((0.034, 0.09), (0.036, 0.05), (0.028, 0.012), (0.02, 0.01), (POLE, 0.01)),
    )
    t = np.linspace(-0.42 * math.pi, 0.42 * math.pi, 24)
    path = np.stack([0.034 + 0.03 * np.cos(t), np.zeros_like(t), 0.05 + 0.027 * np.sin(t)], axis=-1)
    return [(join([body, tube(path, 0.0055, 16)]), "Stoneware")]


def camera() -> Parts:
    """A rangefinder camera, 14 cm wide."""
    body = rounded_box((-0.068, -0.016, 0.006), (0.068, 0.016, 0.06), 0.012)
    metal = [
        rounded_box((-0.068, -0.0165, 0.057), (0.068, 0.0165, 0.08), 0.006),
        rounded_box((-0.068, -0.0165, 0.0), (0.068, 0.0165, 0.009), 0.004),
        turned((0.009, 0.08), (0.0095, 0.088), (0.009, 0.09), (POLE, 0.09), segments=48).moved(x=-0.05),
        turned((0.007, 0.08), (0.007, 0.086), (0.006, 0.087), (POLE, 0.087), segments=48).moved(x=-0.026),
        box((-0.01, -0.008, 0.079), (0.01, 0.01, 0.083)),
    ]
    ring = np.array([(0.031, 0.0), (0.031, 0.006), (0.0285, 0.006), (0.0285, 0.022), (0.027, 0.024), (0.027, 0.034)])
    barrel = lathe(np.concatenate([ring, [(0.0255, 0.036), (0.0235, 0.036), (0.018, 0.028)]]), 96)
    grip = lathe(np.array([(0.0288, 0.008), (0.0302, 0.008), (0.0302, 0.02), (0.0288, 0.02)]), 240, 60, 0.0009)
    rim = lathe(np.array([(0.031, 0.003), (0.0322, 0.004), (0.0322, 0.006), (0.031, 0.007)]), 96)
    glass = turned((0.0185, 0.028), (0.012, 0.033), (POLE, 0.034), segments=64)
    aim = Matrix.Translation((0.006, -0.016, 0.035)) @ FORWARD
    windows = [box((x - w, -0.0172, 0.064), (x + w, -0.016, 0.074)) for x, w in ((0.05, 0.009), (-0.012, 0.005))]
    badge = turned((0.0035, 0.0), (0.0035, 0.0012), (POLE, 0.0014), segments=32)
    return [
        (body, "Leatherette"),
        (join(metal), "Satin steel"),
        (join([barrel, grip]).transformed(aim), "Black plastic"),
        (rim.transformed(aim), "Chrome"),
        (glass.transformed(aim), "Lens glass"),
        (join(windows), "Lens glass"),
        (badge.transformed(Matrix.Translation((0.03, -0.0165, 0.069)) @ FORWARD), "Red enamel"),
    ]


def duck() -> Parts:
    """A toy duck, 9 cm long, that looks along -x."""
    body = ball(1.0, 24, 2.3)
    x, y, z = (body.positions * (0.045, 0.033, 0.026)).T
    tail = np.clip(x / 0.045, 0.0, 1.0) ** 2
    raised = np.stack([x * (1.0 + 0.15 * tail), y * (1.0 - 0.6 * tail), z * (1.0 - 0.5 * tail) + 0.03 * tail], axis=-1)
    wings = [
        ball(1.0, 14).transformed(
            Matrix.Translation((0.008, 0.03 * side, 0.032)) @ Matrix.Diagonal((0.024, 0.007, 0.013, 1.0))
        )
        for side in (-1.0, 1.0)
    ]
    head = ball(0.0235, 20).moved(x=-0.022, z=0.068)
    bill = ball(1.0, 14).transformed(
        Matrix.Translation((-0.046, 0.0, 0.064)) @ Matrix.Diagonal((0.013, 0.012, 0.0045, 1.0))
    )
    eyes = [ball(0.0042, 8).moved(x=-0.038, y=0.0135 * side, z=0.0755) for side in (-1.0, 1.0)]
    return [
        (join([Shape(raised + (0.0, 0.0, 0.026), body.quads, body.uvs), *wings, head]), "Yellow plastic"),
        (bill, "Orange plastic"),
        (join(eyes), "Black plastic"),
    ]


def lacquered_box() -> Parts:
    """A box with a lid, 13 cm wide, and a gold clasp."""
    boxes = [
        rounded_box((-0.065, -0.045, low), (0.065, 0.045, high), 0.006) for low, high in ((0.0, 0.038), (0.0395, 0.055))
    ]
    seam = box((-0.0635, -0.0435, 0.036), (0.0635, 0.0435, 0.042))
    clasp = rounded_box((-0.008, -0.0485, 0.03), (0.008, -0.044, 0.048), 0.002)
    return [(join(boxes), "Lacquer"), (seam, "Gold"), (clasp, "Gold")]


def watch() -> Parts:
    """A wrist watch lying on its side as a closed band, its dial towards -y; 7 cm high."""
    case = lathe(np.array([(POLE, 0.0), (0.018, 0.0), (0.0195, 0.002), (0.0195, 0.008), (0.0185, 0.009)]), 96)
    bezel = turned((0.0185, 0.009), (0.0195, 0.009), (0.018, 0.0115), (0.0165, 0.0105), segments=96)
    disc = grid(*disc_of(0.0167, 48))
    crown = lathe(np.array([(0.0031, 0.0195), (0.0031, 0.0235), (0.0028, 0.024), (POLE, 0.024)]), 96, 24, 0.0004)
    aim = Matrix.Translation((0.0, -0.031, 0.036)) @ FORWARD
    crown = crown.transformed(Matrix.Translation((0.0, 0.0, 0.005)) @ Matrix.Rotation(0.5 * math.pi, 4, "Y"))
    links = []
    for angle in np.linspace(0.5, 2.0 * math.pi - 0.5, 24):
        place = Matrix.Translation((0.0, 0.005 - 0.03 * math.cos(angle), 0.036 + 0.0345 * math.sin(angle)))
        turn = place @ Matrix.Rotation(-angle, 4, "X")
        for x, half in ((-0.0065, 0.0024), (0.0, 0.0035), (0.0065, 0.0024)):
            link = rounded_box((x - half, -0.0012, -0.0036), (x + half, 0.0012, 0.0036), 0.0011, 2)
            links.append(link.transformed(turn))
    return [
        (case.transformed(aim), "Steel"),
        (bezel.transformed(aim), "Chrome"),
        (disc.transformed(aim @ Matrix.Translation((0.0, 0.0, 0.0103))), "Dial"),
        (crown.transformed(aim), "Gold"),
        (join(links), "Satin steel"),
    ]


def disc_of(radius: float, segments: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and coordinates of a disc in the xy plane. The coordinates are 0.02 m at its centre."""
    angles = np.linspace(0.0, 2.0 * np.pi, segments + 1)
    radii = np.array([POLE, radius])[:, None]
    points = np.stack(np.broadcast_arrays(radii * np.cos(angles), radii * np.sin(angles), 0.0), axis=-1)
    return points, points[..., :2] + 0.02


def finger_ring(material: str) -> Parts:
    """A ring that lies on its side."""
    return [(knot(1, 0, 0.0105, 0.0018, 72, 20).moved(z=0.0018), material)]
