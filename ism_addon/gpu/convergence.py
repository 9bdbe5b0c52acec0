# SPDX-License-Identifier: GPL-3.0-or-later
"""How large the error of an image still is, tile by tile, and which tiles are good enough.

The mean of all n samples and that of their first k differ by chance as s² (1/k - 1/n), s² being the variance of one
sample; the mean itself is off by s² / n. So how far a tile has moved while its samples doubled says how far it is from
its end (compare Dammertz et al. 2010, who take every other sample). That is measured on the picture itself, with all
that makes samples err less than chance would: even places, and corrections as far as they are shrinkage. What no sample
has met yet, and what stays wrong for ever (shadow maps), moves nothing and is not in it.
"""

import numpy as np


class Convergence:
    """Of tiles (rows,columns). Errors are root mean squares over the image's mean luminance."""

    def __init__(self, shape: tuple[int, ...]):
        #: Samples that each tile is the mean of, float32; and was when the image was last compared.
        self.counts = np.zeros(shape, np.float32)
        self.half_counts = self.counts
        #: Of one sample; infinite before anything is known.
        self.variance = np.full(shape, np.inf, np.float32)
        #: Whether a tile is good enough, and has no more samples.
        self.converged = np.zeros(shape, bool)

    def update(self, difference: np.ndarray) -> None:
        """By mean squares (rows,columns) by which tiles differ from what they were at `half_counts` samples."""
        more = self.counts > self.half_counts
        gained = np.subtract(1.0 / self.half_counts, 1.0 / self.counts, where=more, out=np.ones_like(difference))
        self.variance = np.where(more, difference / gained, self.variance)

    def stop_below(self, threshold: float) -> None:
        """Tiles whose own error is below `threshold`, and the mean of those about them, have enough samples."""
        squares = self._squares
        self.converged = self.converged | (np.maximum(squares, neighbourhood_mean(squares)) <= threshold**2)

    @property
    def image_error(self) -> float:
        """Infinite before anything is known."""
        return float(np.sqrt(self._squares.mean()))

    @property
    def _squares(self) -> np.ndarray:
        return self.variance / self.counts


def neighbourhood_mean(values: np.ndarray) -> np.ndarray:
    """(H,W): the mean of each one and its eight neighbours."""
    padded = np.pad(values, 1, mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, (3, 3)).mean((2, 3))
