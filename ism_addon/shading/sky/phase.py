# SPDX-License-Identifier: GPL-3.0-or-later
"""Phase functions, 1/sr, of cosines of the angle by which light is scattered."""

import numpy as np


def rayleigh(cosine: np.ndarray) -> np.ndarray:
    """Molecules of air."""
    return 3.0 / (16.0 * np.pi) * (1.0 + cosine * cosine)


def henyey_greenstein(cosine: np.ndarray, anisotropy: float) -> np.ndarray:
    """Aerosols of this mean cosine."""
    squared = anisotropy * anisotropy
    return (1.0 - squared) / (4.0 * np.pi) / (1.0 + squared - 2.0 * anisotropy * cosine) ** 1.5


def cornette_shanks(cosine: np.ndarray, anisotropy: float) -> np.ndarray:
    """Aerosols: the same times that of air, 1 in total (Cornette and Shanks 1992)."""
    total = (2.0 + anisotropy * anisotropy) / 3.0
    return 0.5 * (1.0 + cosine * cosine) / total * henyey_greenstein(cosine, anisotropy)
