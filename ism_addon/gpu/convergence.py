# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates the error of an image by tile, and which tiles have converged.

The expected squared difference between the mean of n samples and the mean of their first k is s² (1/k - 1/n), where s²
is the variance of one sample; the squared error of the mean is s² / n. So the change of a tile while its samples double
gives its error (compare Dammertz et al. 2010, who take every other sample). The change is measured on the image itself,
so the error includes the gain by stratification and by shrunken residuals. It does not include features that no sample
has hit yet, nor bias (shadow maps).
"""

import numpy as np


class Convergence:
    """Convergence of the tiles: arrays (rows,columns). Errors are RMS, relative to the image's mean luminance."""

    def __init__(self, shape: tuple[int, ...]):
        #: Samples of each tile, float32: now, and when the image was last compared.
        self.counts = np.zeros(shape, np.float32)
        self.half_counts = self.counts
        #: Variance of one sample; infinite before the first estimate.
        self.variance = np.full(shape, np.inf, np.float32)
        #: Whether a tile needs no more samples.
        self.converged = np.zeros(shape, bool)

    def update(self, difference: np.ndarray) -> None:
        """Estimate the variance from mean squared differences (rows,columns) to the image at `half_counts`.

        Tiles that have converged since then keep their estimate: the difference of the few samples that they got is
        noisy, and they get no others that would correct it, so their neighbours might never converge.
        """
        has_new_samples = (self.counts > self.half_counts) & ~self.converged
        one = np.ones_like(difference)
        expected = np.subtract(1.0 / self.half_counts, 1.0 / self.counts, where=has_new_samples, out=one)
        self.variance = np.where(has_new_samples, difference / expected, self.variance)

    def stop_below(self, threshold: float | np.ndarray) -> None:
        """Mark tiles as converged whose error and mean error of their neighbourhood are below `threshold`.

        It may be an array (rows,columns).
        """
        squares = self._squares
        self.converged = self.converged | (np.maximum(squares, neighbourhood_mean(squares)) <= threshold**2)

    @property
    def image_error(self) -> float:
        """RMS error of the image; infinite before the first estimate."""
        return float(np.sqrt(self._squares.mean()))

    @property
    def _squares(self) -> np.ndarray:
        return self.variance / self.counts


def neighbourhood_mean(values: np.ndarray) -> np.ndarray:
    """(H,W): the mean of each element and its eight neighbours."""
    padded = np.pad(values, 1, mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, (3, 3)).mean((2, 3))
