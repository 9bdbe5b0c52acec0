# SPDX-License-Identifier: GPL-3.0-or-later
"""Hanging cloths: curtains, banners and swags, each around its origin."""

import numpy as np

from tests.scenes.parts.shapes import Shape, grid


def curtain(width: float, height: float, pleats: int, seed: int, gather: float = 0.0, steps: int = 64) -> Shape:
    """A pleated curtain below z = 0. `gather` is the fraction of its width that a tie removes at 60 % of its height."""
    u, v = sheet(7 * pleats, steps)
    drift = waves(u, v, seed)
    depth = 0.03 + 0.055 * v**0.7
    waist = 1.0 - gather * np.exp(-(((v - 0.6) / 0.22) ** 2)) - 0.35 * gather * np.clip((v - 0.6) / 0.4, 0.0, 1.0)
    phase = 2.0 * np.pi * pleats * (u + 0.02 * drift * v)
    x = width * ((u - 0.5 + 0.02 * drift * v) * waist - 0.5 * (1.0 - waist) * np.sign(gather))
    x = x + 0.25 * depth * np.sin(2.0 * phase)
    y = depth * np.sin(phase) * (0.8 + 0.2 * waist) + 0.05 * v**2 * drift
    z = -height * v + 0.02 * v * np.cos(phase)
    stretch = 1.0 + 0.6 * pleats * 0.08 / width
    return grid(np.stack([x, y, z], -1), np.stack([stretch * width * u, -height * v], -1))


def banner(width: float, height: float, seed: int, steps: int = 72) -> Shape:
    """A heavy cloth below z = 0, with long folds that widen towards its hem."""
    u, v = sheet(48, steps)
    drift = waves(u, v, seed)
    fold = np.sin(2.0 * np.pi * 2.5 * u + 1.1 * drift + 0.8 * seed) + 0.4 * np.sin(2.0 * np.pi * 6.0 * u - 1.3 * drift)
    y = 0.085 * v**0.8 * fold + 0.05 * np.sin(2.6 * v + seed) * v
    x = width * (u - 0.5) * (1.0 - 0.05 * v) + 0.02 * v * drift
    sag = 0.05 * np.sin(np.pi * u) * v
    return grid(np.stack([x, y, -height * v - sag], -1), np.stack([width * u, height * (1.0 - v)], -1))


def swag(span: float, width: float, sag: float, seed: int, steps: int = 96) -> Shape:
    """A cloth hung along y between two sides, `sag` lower in the middle, with ripples across its width."""
    u, v = sheet(40, steps)
    drift = waves(v, u, seed)
    t = 2.0 * v - 1.0
    ends = np.abs(t) ** 6
    waist = 1.0 - 0.45 * ends
    ripple = np.sin(2.0 * np.pi * 4.0 * u + 0.6 * drift)
    x = width * (u - 0.5) * waist + 0.04 * drift
    z = -sag * (1.0 - t**2) * (1.0 + 0.22 * np.sin(np.pi * u)) + (0.03 + 0.06 * ends) * ripple
    length = span * (1.0 + 2.7 * (sag / span) ** 2)
    return grid(np.stack([x, 0.5 * span * t, z], -1), np.stack([width * u, length * v], -1))


def sheet(columns: int, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates across and down a sheet, 0..1: two arrays (rows + 1, columns + 1)."""
    v, u = np.meshgrid(np.linspace(0.0, 1.0, rows + 1), np.linspace(0.0, 1.0, columns + 1), indexing="ij")
    return u, v


def waves(u: np.ndarray, v: np.ndarray, seed: int) -> np.ndarray:
    """A smooth random wave over a sheet, about -1..1, so that cloths differ."""
    random = np.random.default_rng(seed)
    total = np.zeros_like(u)
    for frequency in (1.0, 2.0, 3.5):
        a, b, phase = random.uniform(-1.0, 1.0), random.uniform(-0.6, 0.6), random.uniform(0.0, 2.0 * np.pi)
        total += np.sin(2.0 * np.pi * frequency * (a * u + b * v) + phase) / frequency
    return total / 1.8
