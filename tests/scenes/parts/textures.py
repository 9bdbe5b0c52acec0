# SPDX-License-Identifier: GPL-3.0-or-later
"""Procedural image textures: stone, paving, plaster, wood, cloth. (H,W,3), sRGB-encoded, 0..1, and tileable."""

import numpy as np

Color = tuple[float, float, float]


def noise(size: int, exponent: float, seed: int) -> np.ndarray:
    """Periodic fractal noise (size,size), mean 0, standard deviation 1. A larger `exponent` (1..3) is smoother."""
    spectrum = np.fft.rfft2(np.random.default_rng(seed).standard_normal((size, size)))
    frequency = np.hypot(np.fft.fftfreq(size)[:, None], np.fft.rfftfreq(size)[None, :])
    frequency[0, 0] = np.inf
    field = np.fft.irfft2(spectrum * frequency**-exponent, s=(size, size))
    return field / field.std()


def mix(a: np.ndarray | Color, b: np.ndarray | Color, amount: np.ndarray) -> np.ndarray:
    """Linear interpolation from colour a to colour b by amount (H,W), clamped to 0..1."""
    t = np.clip(amount, 0.0, 1.0)[..., None]
    return (1.0 - t) * np.asarray(a) + t * np.asarray(b)


def pixels(size: int) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates of the pixel centres across and up a texture, 0..1."""
    line = (np.arange(size) + 0.5) / size
    y, x = np.meshgrid(line, line, indexing="ij")
    return x, y


def edges(x: np.ndarray, y: np.ndarray, wobble: np.ndarray) -> np.ndarray:
    """Distance to the nearest edge of unit cells, plus `wobble`, which makes the edge uneven."""
    return np.minimum(0.5 - np.abs(x % 1.0 - 0.5), 0.5 - np.abs(y % 1.0 - 0.5)) + wobble


def stone_blocks(size: int = 1024, courses: int = 8, per_course: int = 4, seed: int = 1) -> np.ndarray:
    """Sandstone blocks in a running bond with recessed mortar; `courses` rows of `per_course` blocks."""
    x, y = pixels(size)
    row = np.floor(y * courses).astype(int)
    across = x * per_course + 0.5 * (row % 2)
    column = np.floor(across).astype(int) % per_course
    random = np.random.default_rng(seed)
    tone, hue = random.normal(0.0, 1.0, (2, courses, per_course))
    aspect = courses / per_course
    fine, broad = noise(size, 0.9, seed + 1), noise(size, 1.7, seed + 2)
    dx = (0.5 - np.abs(across % 1.0 - 0.5)) * aspect
    dy = 0.5 - np.abs((y * courses) % 1.0 - 0.5)
    distance = np.minimum(dx, dy) + 0.006 * fine
    stone = mix((0.70, 0.615, 0.50), (0.80, 0.735, 0.64), 0.5 + 0.26 * tone[row, column] + 0.18 * broad)
    stone *= (1.0 + 0.03 * hue[row, column][..., None] * np.array([1.0, 0.0, -1.0])) * (1.0 + 0.028 * fine[..., None])
    stone *= 1.0 - 0.16 * np.exp(-((distance / 0.055) ** 2))[..., None]
    return np.clip(mix((0.52, 0.47, 0.40), stone, (distance - 0.018) / 0.014), 0.0, 1.0)


def limestone(size: int = 512, seed: int = 11) -> np.ndarray:
    """Pale stone with faint bedding and pores, for pillars and mouldings."""
    fine, broad = noise(size, 0.7, seed), noise(size, 1.6, seed + 1)
    _, y = pixels(size)
    bedding = np.sin(2.0 * np.pi * (6.0 * y + 0.12 * broad))
    color = mix((0.74, 0.69, 0.605), (0.86, 0.825, 0.765), 0.5 + 0.2 * broad + 0.09 * bedding)
    pores = np.clip(-fine - 1.7, 0.0, 1.0)
    return np.clip(color * (1.0 + 0.02 * fine - 0.22 * pores)[..., None], 0.0, 1.0)


def paving(size: int = 1024, tiles: int = 4, seed: int = 21) -> np.ndarray:
    """Square slabs of uneven tone, with dark diamonds in their corners."""
    x, y = pixels(size)
    fine, broad, veins = noise(size, 0.8, seed), noise(size, 1.6, seed + 1), noise(size, 1.3, seed + 2)
    tx, ty = x * tiles, y * tiles
    tone = np.random.default_rng(seed).normal(0.0, 1.0, (tiles, tiles))
    tile = tone[np.floor(ty).astype(int), np.floor(tx).astype(int)]
    slabs = mix((0.60, 0.545, 0.47), (0.73, 0.685, 0.615), 0.5 + 0.24 * tile + 0.16 * broad)
    slabs *= 1.0 - 0.07 * np.exp(-((veins / 0.07) ** 2))[..., None]
    corner = np.abs((tx + 0.5) % 1.0 - 0.5) + np.abs((ty + 0.5) % 1.0 - 0.5)
    inlay = mix((0.34, 0.22, 0.18), (0.43, 0.29, 0.23), 0.5 + 0.4 * broad)
    color = mix(inlay, slabs, (corner - 0.17) / 0.006)
    joint = np.minimum(np.where(corner > 0.17, edges(tx, ty, 0.001 * fine), 1.0), np.abs(corner - 0.17) + 0.001 * fine)
    color = mix((0.36, 0.32, 0.275), color, (joint - 0.005) / 0.005)
    return np.clip(color * (1.0 + 0.03 * fine + 0.03 * broad)[..., None], 0.0, 1.0)


def plaster(size: int = 512, seed: int = 31) -> np.ndarray:
    """Warm lime plaster with large blotches."""
    fine, broad = noise(size, 0.9, seed), noise(size, 1.8, seed + 1)
    color = mix((0.80, 0.70, 0.555), (0.875, 0.80, 0.68), 0.5 + 0.28 * broad)
    return np.clip(color * (1.0 + 0.015 * fine)[..., None], 0.0, 1.0)


def wood(size: int = 512, planks: int = 4, seed: int = 41) -> np.ndarray:
    """Dark oak planks along u."""
    _, y = pixels(size)
    broad, fine = noise(size, 1.5, seed), noise(size, 0.7, seed + 1)
    streaks = np.repeat(noise(size, 0.8, seed + 2)[:, :1], size, axis=1)
    plank = np.random.default_rng(seed).normal(0.0, 1.0, planks)[np.floor(y * planks).astype(int)]
    grain = np.sin(2.0 * np.pi * (18.0 * y + 0.35 * broad))
    color = mix((0.30, 0.20, 0.125), (0.47, 0.335, 0.22), 0.5 + 0.16 * plank + 0.12 * grain + 0.12 * streaks)
    gap = 0.5 - np.abs((y * planks) % 1.0 - 0.5)
    return np.clip(color * (1.0 + 0.03 * fine)[..., None] * np.clip(gap / 0.02, 0.35, 1.0)[..., None], 0.0, 1.0)


def damask(ground: Color, figure: Color, size: int = 512, seed: int = 51) -> np.ndarray:
    """Woven cloth with a lattice of ogees and flowers of the colour `figure` on the colour `ground`."""
    x, y = pixels(size)
    tau = 2.0 * np.pi
    lattice = np.cos(tau * 2 * x) * np.cos(tau * y) + 0.22 * np.cos(tau * 4 * x) * np.cos(tau * 2 * y)
    ogee = 1.0 - np.abs(np.abs(lattice) - 0.30) / 0.09
    angle, radius = flower(x, y)
    petals = (0.62 + 0.38 * np.cos(6.0 * angle)) - radius / 0.55
    heart = 1.0 - np.abs(radius - 0.12) / 0.05
    motif = np.clip(np.maximum(np.maximum(8.0 * petals, 3.0 * ogee), 3.0 * heart), 0.0, 1.0)
    threads = 0.5 * (np.sin(tau * 128 * x) + np.sin(tau * 128 * y))
    shade = 1.0 + 0.035 * threads + 0.03 * noise(size, 1.4, seed)
    return np.clip(mix(ground, figure, 0.8 * motif) * shade[..., None], 0.0, 1.0)


def flower(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Polar coordinates around the centres of the ogees: angle, and radius (1 at the edge to the next ogee)."""
    fx, fy = (2.0 * x + 0.5) % 1.0 - 0.5, (y + 0.5 * (np.floor(2.0 * x + 0.5) % 2.0) + 0.5) % 1.0 - 0.5
    return np.arctan2(1.6 * fy, fx), np.hypot(1.6 * fy, fx) * 2.0


def bordered(cloth: np.ndarray, repeats: tuple[int, int], trim: Color, shape: tuple[int, int]) -> np.ndarray:
    """A banner of `shape` (H,W) pixels: the cloth repeated (across, up) times, with a double border of `trim`."""
    height, width = shape
    rows = (np.arange(height) * repeats[1] * cloth.shape[0] // height) % cloth.shape[0]
    columns = (np.arange(width) * repeats[0] * cloth.shape[1] // width) % cloth.shape[1]
    image = cloth[rows][:, columns]
    y, x = np.meshgrid(np.arange(height), np.arange(width), indexing="ij")
    edge = np.minimum(np.minimum(x, width - 1 - x), np.minimum(y, height - 1 - y)) / width
    stripe = np.maximum(1.0 - np.abs(edge - 0.035) / 0.02, 1.0 - np.abs(edge - 0.085) / 0.008)
    return np.clip(mix(image, trim, np.clip(6.0 * stripe, 0.0, 0.9)), 0.0, 1.0)
