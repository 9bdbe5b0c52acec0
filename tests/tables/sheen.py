# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of Cycles' sheen, measured in its pictures: Zeltner, Burley & Chiang 2022.

Their sheen is a transformed cosine with the inverse matrix [[a,0,b],[0,a,0],[0,0,1]], times an albedo R. Suns from
six directions show the product at a roughness and an angle, from which a, b and R follow.
"""

import numpy as np

from tests.tables import furnace

COUNT = 32
#: Cycles' sheen begins here.
SMALLEST_ROUGHNESS = 1e-3
#: At a cosine of 0 nothing is seen: the view for the first column is halfway to the next.
FIRST_COLUMN = 0.5
#: The viewer's azimuth must be defined.
LARGEST_COSINE = 1.0 - 1e-7
#: Albedos below are not sheen, nor is what is not of its form.
FAINTEST, TOLERANCE = 2e-5, 1e-3


def suns() -> np.ndarray:
    """(6,3) unit vectors, in and across the plane of x and z."""
    directions = np.array([[0, 0, 1], [1, 0, 1], [-1, 0, 1], [0, 1, 1], [-2, 0, 1], [1.5, 1.5, 1]], np.float64)
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


def evaluate(parameters: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """(…,D): BRDF times the light's cosine, for a, b and R (…,3)."""
    a, b, r = (parameters[..., k, None] for k in range(3))
    x, y, z = directions.T
    return r * a**2 * z / (np.pi * ((a * x + b * z) ** 2 + (a * y) ** 2 + z**2) ** 2)


def solve(values: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """(K,3) a, b and R whose values these are (K,D).

    √(z / value) is a quadratic form of the direction, whose coefficients follow from linear equations.
    """
    x, y, z = directions.T
    forms = np.stack([x**2 + y**2, x * z, z**2], 1)
    square, mixed, rest = np.linalg.pinv(forms) @ np.sqrt(z / values).T
    ratio = 0.5 * mixed / square  # b / a
    a = 1.0 / np.sqrt(rest / square - ratio**2)
    return np.stack([a, ratio * a, np.pi * (a / square) ** 2], 1)


def table() -> np.ndarray:
    """(32,32,3) a, b and R by roughness and cosine. Where R is 0, a and b are those of the next roughness."""
    roughness = np.maximum(np.linspace(0.0, 1.0, COUNT), SMALLEST_ROUGHNESS)
    white = np.ones(3)
    shaders = [furnace.shader("ShaderNodeBsdfSheen", {}, {"Roughness": each, "Color": white}) for each in roughness]
    columns = np.arange(COUNT, dtype=np.float64)
    columns[0] = FIRST_COLUMN
    cosines = np.minimum(columns / (COUNT - 1), LARGEST_COSINE)
    values = np.stack([furnace.under_suns(shaders, cosine, suns())[..., 0].T for cosine in cosines], 1)
    visible = values.min(-1) > 0.0
    result = np.zeros((COUNT, COUNT, 3))
    result[visible] = solve(values[visible], suns())
    visible &= (result[..., 2] > FAINTEST) & (np.abs(evaluate(result, suns()) - values) < TOLERANCE * values).all(-1)
    for row in reversed(range(COUNT - 1)):
        result[row, ~visible[row], :2] = result[row + 1, ~visible[row], :2]
        result[row, ~visible[row], 2] = 0.0
    # Cycles interpolates linearly towards the column that is not seen.
    extrapolated = (result[:, 0] - FIRST_COLUMN * result[:, 1]) / (1.0 - FIRST_COLUMN)
    result[:, 0] = np.where(visible[:, 1, None], extrapolated, result[:, 0])
    return result
