# SPDX-License-Identifier: GPL-3.0-or-later
"""Linearly transformed cosines fitted to GGX lobes: Heitz, Dupuy, Hill & Neubelt 2016, with all four coefficients free.

The view is in the plane of x and z. By symmetry, the inverse matrix is [[a,0,b],[0,1,0],[c,0,d]] up to a factor. Heitz
et al. let the transformed z axis be the lobe's mean direction; here it is fitted too, which more than halves the error.
All entries are fitted at once by Levenberg & Marquardt's method. Small lobes are exact: seen along the normal, GGX and
the transformed cosine are both 1/(1 + t²/4α²)² of the slope t.
"""

import numpy as np

from tests.tables import ggx

#: Entries along roughness, and along √(1 - cosine of the view).
COUNT = 32
#: The first row and the last column are fitted here instead of at 0.
SMALLEST_ROUGHNESS, SMALLEST_COSINE = 1e-3, 5e-3
#: The squared difference is divided by the sum of both densities, plus this part of the lobe's peak. 0 would be the
#: variance of a control variate's samples; a large value only counts the peak. In between, lights' errors are least.
PEAK_FRACTION = 0.1
#: Weight of directions below the horizon, where the lobe is 0. Fully counted, they make the fit above worse by a tenth.
WEIGHT_BELOW = 0.3
#: Midpoints of the visible normals: azimuths in half a turn and heights; and azimuths of uniform directions.
AZIMUTHS, HEIGHTS, UNIFORM = 14, 28, 8
#: A second set of visible normals is for lobes so many times as rough.
WIDER = 3.0
ITERATIONS, SWEEPS, SWEEP_ITERATIONS = 25, 3, 10
MAX_STEP, DIFFERENCE = 0.3, 1e-5


def coefficients(parameters: np.ndarray) -> np.ndarray:
    """(…,4) a, b, c, d from logarithms of the scales along x and z, angle of z, and shear (…,4)."""
    x, z = np.exp(parameters[..., 0]), np.exp(parameters[..., 1])
    cosine, sine, shear = np.cos(parameters[..., 2]), np.sin(parameters[..., 2]), parameters[..., 3]
    return np.stack([x * cosine - shear * sine, -x * sine - shear * cosine, z * sine, z * cosine], -1)


def transform(inverse: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """(…,3): inverse matrices (…,4) times directions (…,3)."""
    a, b, c, d = np.moveaxis(inverse, -1, 0)
    x, y, z = np.moveaxis(directions, -1, 0)
    return np.stack(np.broadcast_arrays(a * x + b * z, y, c * x + d * z), -1)


def density(inverse: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """The transformed cosine per steradian; its integral over the sphere is 1."""
    a, b, c, d = np.moveaxis(inverse, -1, 0)
    transformed = transform(inverse, directions)
    return np.maximum(transformed[..., 2], 0.0) * (a * d - b * c) / (np.pi * (transformed**2).sum(-1) ** 2)


class Lobes:
    """Directions with weights for integrals over K lobes, and the lobes' values there."""

    def __init__(self, roughness: np.ndarray, cosine: np.ndarray):
        self.alpha, self.cosine = roughness**2, cosine
        wi = ggx.direction(cosine)[:, None]
        u, v = midpoints(AZIMUTHS, 2 * AZIMUTHS, HEIGHTS)
        alphas = [each[:, None] for each in (self.alpha, np.minimum(WIDER * self.alpha, 1.0))]
        sets = [ggx.reflect(wi, ggx.sample_visible_normal(wi, alpha, u, v)) for alpha in alphas]
        phi, height = midpoints(UNIFORM, UNIFORM, 2 * UNIFORM)
        z = 2.0 * height - 1.0
        uniform = np.stack([np.sqrt(1.0 - z**2) * np.cos(np.pi * phi), np.sqrt(1.0 - z**2) * np.sin(np.pi * phi), z], 1)
        self.directions = np.concatenate([*sets, np.broadcast_to(uniform, (len(cosine), *uniform.shape))], 1)
        # The balance heuristic of Veach & Guibas 1995.
        h = wi + self.directions
        reflects = h[..., 2] > 0.0
        densities = [np.where(reflects, ggx.density(wi, self.directions, alpha), 0.0) for alpha in alphas]
        weights = 1.0 / (len(u) * sum(densities) + len(uniform) / (4.0 * np.pi))
        values = ggx.evaluate(wi, self.directions, alphas[0])
        self.values = values / (values * weights).sum(1, keepdims=True)
        self.root_weights = np.sqrt(weights * np.where(self.directions[..., 2] > 0.0, 1.0, WEIGHT_BELOW))
        self.offset = PEAK_FRACTION * self.values.max(1, keepdims=True)

    def residuals(self, parameters: np.ndarray) -> np.ndarray:
        """(K,N) whose sums of squares are the errors of transformed cosines."""
        fitted = density(coefficients(parameters)[:, None], self.directions)
        return self.root_weights * (fitted - self.values) / np.sqrt(fitted + self.values + self.offset)

    def first_guesses(self) -> list[np.ndarray]:
        """(K,4) parameters of a smooth surface's lobe, about the mirror direction, and of a rough one's."""
        angle = -np.arccos(self.cosine)
        width = np.log(2.0 * self.alpha * np.maximum(self.cosine, 0.05) / (1.0 + self.alpha))
        zero = np.zeros_like(angle)
        smooth = np.stack([np.log(np.maximum(self.cosine, 0.05)), width, angle, zero], -1)
        return [smooth, np.stack([zero, np.log(1.4 * self.alpha), zero, zero], -1)]

    def fit(self, parameters: np.ndarray, iterations: int) -> tuple[np.ndarray, np.ndarray]:
        """(K,4) parameters after Levenberg and Marquardt's iterations, (K,) their errors."""
        residuals = self.residuals(parameters)
        errors = (residuals**2).sum(1)
        damping = np.full(len(errors), 1e-2)
        for _ in range(iterations):
            moved = [self.residuals(parameters + DIFFERENCE * axis) for axis in np.eye(4)]
            jacobian = np.stack([(each - residuals) / DIFFERENCE for each in moved], -1)
            normal = np.swapaxes(jacobian, 1, 2) @ jacobian
            gradient = (jacobian * residuals[..., None]).sum(1)
            diagonal = np.einsum("kpp->kp", normal)
            damped = damping[:, None] * (diagonal + 1e-6 * diagonal.max(1, keepdims=True) + 1e-12)
            step = np.linalg.solve(normal + damped[..., None] * np.eye(4), -gradient[..., None])[..., 0]
            trial = parameters + np.clip(step, -MAX_STEP, MAX_STEP)
            trial_residuals = self.residuals(trial)
            trial_errors = (trial_residuals**2).sum(1)
            better = trial_errors < errors
            parameters = np.where(better[:, None], trial, parameters)
            residuals = np.where(better[:, None], trial_residuals, residuals)
            errors = np.where(better, trial_errors, errors)
            damping = np.clip(np.where(better, 0.3 * damping, 5.0 * damping), 1e-9, 1e6)
        return parameters, errors


def midpoints(columns: int, of_columns: int, rows: int) -> tuple[np.ndarray, np.ndarray]:
    u, v = np.meshgrid((np.arange(columns) + 0.5) / of_columns, (np.arange(rows) + 0.5) / rows)
    return u.ravel(), v.ravel()


def neighbour_means(grid: np.ndarray) -> np.ndarray:
    padded = np.pad(grid, ((1, 1), (1, 1), (0, 0)), "reflect", reflect_type="odd")
    return 0.25 * (padded[2:, 1:-1] + padded[:-2, 1:-1] + padded[1:-1, 2:] + padded[1:-1, :-2])


def axes() -> tuple[np.ndarray, np.ndarray]:
    """Roughness of the rows, cosines of the columns."""
    roughness = np.maximum(np.linspace(0.0, 1.0, COUNT), SMALLEST_ROUGHNESS)
    cosine = np.clip(1.0 - np.linspace(0.0, 1.0, COUNT) ** 2, SMALLEST_COSINE, 1.0 - 1e-9)
    return roughness, cosine


def fit() -> np.ndarray:
    """(32,32,4) inverse matrices by roughness and √(1 - cosine)."""
    roughness, cosine = axes()
    lobes = Lobes(*(each.ravel() for each in np.meshgrid(roughness, cosine, indexing="ij")))
    best, least = np.zeros((len(lobes.alpha), 4)), np.full(len(lobes.alpha), np.inf)

    def keep(parameters: np.ndarray, errors: np.ndarray, tolerance: float = 0.0) -> None:
        better = errors < least * (1.0 + tolerance)
        best[better], least[better] = parameters[better], errors[better]

    for guess in lobes.first_guesses():
        keep(*lobes.fit(guess, ITERATIONS))
    # What a neighbour's parameters lead to as well is a smoother table.
    for _ in range(SWEEPS):
        keep(*lobes.fit(neighbour_means(best.reshape(COUNT, COUNT, 4)).reshape(-1, 4), SWEEP_ITERATIONS), 0.01)
    return coefficients(best).reshape(COUNT, COUNT, 4)


def rotated(inverse: np.ndarray, cosine: np.ndarray, sine: np.ndarray) -> np.ndarray:
    """(…,4) coefficients of the matrix times the rotation that takes the mirror direction (-sine,0,cosine) to z."""
    a, b, c, d = np.moveaxis(inverse, -1, 0)
    return np.stack([a * cosine - b * sine, a * sine + b * cosine, c * cosine - d * sine, c * sine + d * cosine], -1)


def table() -> np.ndarray:
    """(32,32,4) by roughness and √(1 - cosine): a, b/α, c/α, d/α for coordinates where z is the mirror direction.

    They are smooth down to α = 0, and interpolation does not move small lobes.
    """
    roughness, cosine = axes()
    alpha = roughness[:, None] ** 2
    scale = np.stack(np.broadcast_arrays(1.0, alpha, alpha, alpha), -1)
    return rotated(fit(), cosine, -np.sqrt(1.0 - cosine**2)) / scale
