# SPDX-License-Identifier: GPL-3.0-or-later
"""How large the error of a picture still is, block by block, and which blocks are good enough.

The mean of all n samples and that of their first k differ by chance as s² (1/k - 1/n), s² being the variance of one
sample; the mean itself is off by s² / n. So how far a block has moved while its samples doubled says how far it is from
its end (compare Dammertz et al. 2010, who take every other sample). That is measured on the picture itself, with all
that makes samples err less than chance would: even places, and corrections as far as they are shrinkage. What no sample
has met yet, and what stays wrong for ever (shadow maps), moves nothing and is not in it.
"""

import numpy as np


class Convergence:
    """Of blocks (H,W). Errors are root mean squares over the picture's mean brightness."""

    def __init__(self, shape: tuple[int, int]):
        #: Samples that each block is the mean of.
        self.counts = np.zeros(shape, np.float32)
        #: Of one sample; infinite before anything is known.
        self.variance = np.full(shape, np.inf, np.float32)
        #: Whether a block is good enough, and has no more samples.
        self.settled = np.zeros(shape, bool)

    def count(self, takes_part: np.ndarray) -> None:
        """Blocks (H,W) bool have one more sample, but those that are settled."""
        self.counts += takes_part & ~self.settled

    def compare(self, moved: np.ndarray, earlier: np.ndarray) -> None:
        """Mean squares (H,W) by which blocks differ from what they were when they had `earlier` (H,W) samples."""
        more = self.counts > earlier
        gained = np.subtract(1.0 / earlier, 1.0 / self.counts, where=more, out=np.ones_like(moved))
        self.variance = np.where(more, moved / gained, self.variance)

    def settle(self, threshold: float) -> None:
        """Blocks whose own error is below `threshold`, and that of those about them, have enough samples."""
        squares = self._squares
        self.settled |= np.maximum(squares, neighbourhood_mean(squares)) <= threshold**2

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
