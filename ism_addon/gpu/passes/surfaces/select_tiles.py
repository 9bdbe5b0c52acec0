# SPDX-License-Identifier: GPL-3.0-or-later
"""Which parts of the picture a sample is spent on: those that samples still change, and as much as they do.

After the first few samples, blocks of pixels take part with a chance by the standard deviation of their samples, so
that for a given number of pixels drawn the least error is left (Neyman 1934). A block is averaged over the samples that
it took part in. One whose error is below the threshold takes part only for the pixels of those beside it.
"""

from dataclasses import dataclass
from functools import cached_property

import moderngl
import numpy as np

from ....resources import (
    CONVERGENCE,
    MEAN_LUMINANCE,
    SAMPLES_PER_TILE,
    SUM_COLOR,
    SUM_RESIDUAL,
    SUM_WEIGHTS,
    TILE_PROBABILITIES,
    TILE_SAMPLE_COUNTS,
    TILE_SELECTION,
    TILE_SIZE,
    TILE_VARIANCE,
    TILES,
)
from ....sampling.dimensions import Dimension, draw
from ....scene import Change
from ...drawing import draw_per_tile
from ...frame import Frame, Pass, has_doubled, outputs
from ...tiles import from_strips, tiles_where

#: Samples that every block takes part in.
UNIFORM_SAMPLES = 2

#: The least chance of a block after them, and the part of the blocks that still take part for sure.
MIN_TILE_PROBABILITY = 0.06
ALWAYS_SAMPLED_FRACTION = 0.1

#: The variance of a mean of n samples falls like this power of 1 / n: they are spread evenly, and edges are the more of
#: it (Mitchell 1996).
VARIANCE_EXPONENT = 1.5

#: The sum of noise² / n^VARIANCE_EXPONENT is least, for a given sum of n, where n is in proportion to this power of the
#: noise.
ALLOCATION_EXPONENT = 2.0 / (1.0 + VARIANCE_EXPONENT)

#: The least chance of a block beside another, as a part of the other's: its samples count for that one's pixels too, by
#: as much more as it takes part less often, and a few that count for many make borders that show.
MIN_NEIGHBOUR_RATIO = 0.25

#: What sums of float32 leave of no noise at all, as a part of the mean luminance.
SUM_ROUNDING = 5e-4
FLOAT32_TINY = float(np.finfo(np.float32).tiny)


@dataclass
class TileSelection:
    """How often each tile takes part: arrays (rows,columns) float32."""

    sample_counts: np.ndarray  # samples so far, of a tile that has converged those for its neighbours too
    probabilities: np.ndarray


class SelectTiles(Pass):
    """The tiles that take part in this sample, and in how many each did so far."""

    inputs = Change.VIEW, Change.SAMPLE, "shadow.method", "shortcuts"
    feedback = SUM_COLOR, SUM_RESIDUAL, SUM_WEIGHTS, CONVERGENCE
    outputs = outputs(
        *(TILES, TILE_SELECTION, SAMPLES_PER_TILE, TILE_SAMPLE_COUNTS, TILE_PROBABILITIES, TILE_VARIANCE),
        MEAN_LUMINANCE,
    )

    @cached_property
    def variance(self) -> moderngl.VertexArray:
        return self.full_screen_program(tile_size=TILE_SIZE)

    def execute(self, frame: Frame) -> None:
        columns, rows = frame.tiles
        if frame.sample == 0:
            self.reset(frame)
        selection, first = frame[TILE_SELECTION], frame.sample == 0
        converged = np.zeros((rows, columns), bool) if first else frame[CONVERGENCE].converged
        if has_doubled(frame.sample):
            deviation, frame[MEAN_LUMINANCE] = self.tile_statistics(frame)
            adaptive = frame.settings.shortcuts and all(estimator.adaptive for estimator in frame.estimators)
            if adaptive and frame.sample >= UNIFORM_SAMPLES and not converged.all():
                selection.probabilities = allocate(deviation, frame[MEAN_LUMINANCE], ~converged)
        turns = draw(Dimension.TILE_TURN, sample=frame.sample, tile=np.arange(columns * rows)).reshape(rows, columns)
        takes_part = turns < selection.probabilities
        takes_part &= neighbourhood_max(~converged)
        frame[TILES] = self.tiles(frame, takes_part)
        frame.counts["pixels_drawn"] += len(frame[TILES]) * TILE_SIZE**2
        selection.sample_counts += takes_part
        frame[SAMPLES_PER_TILE] = frame[SAMPLES_PER_TILE] + (takes_part & ~converged)
        probabilities = np.stack([selection.probabilities, selection.probabilities * ~converged], 2)
        frame[TILE_SAMPLE_COUNTS].write(frame[SAMPLES_PER_TILE], (0, 0, columns, rows))
        frame[TILE_PROBABILITIES].write(probabilities, (0, 0, columns, rows))

    @staticmethod
    def reset(frame: Frame) -> None:
        """All tiles, none drawn yet."""
        columns, rows = frame.tiles
        none, all_tiles = (np.full((rows, columns), value, np.float32) for value in (0.0, 1.0))
        frame[TILE_SELECTION] = TileSelection(none, all_tiles)
        frame[SAMPLES_PER_TILE] = none.copy()

    @staticmethod
    def tiles(frame: Frame, takes_part: np.ndarray) -> np.ndarray:
        """Rows of TILE. Each tile goes through the places in a pixel at its own pace."""
        tiles = tiles_where(takes_part)
        tiles["sample_index"] = frame[TILE_SELECTION].sample_counts[takes_part]
        index = tiles["sample_index"].astype(np.int64) % len(frame.grid.places)
        tiles["visibility_texel"], tiles["subpixel_offset"] = frame.grid.texels[index], frame.grid.places[index]
        return tiles

    def tile_statistics(self, frame: Frame) -> tuple[np.ndarray, float]:
        """Standard deviation (rows,columns) of the luminance of tiles' samples, and the image's mean luminance."""
        sums = {"sum_color": frame[SUM_COLOR], "sum_residual": frame[SUM_RESIDUAL], "sum_weights": frame[SUM_WEIGHTS]}
        draw_per_tile(frame, frame.framebuffer(TILE_VARIANCE), self.variance, **sums)
        self.device.wait()
        texels = from_strips(frame.read(TILE_VARIANCE), frame.tiles)
        variance, luminance = np.moveaxis(texels, -1, 0)
        return np.sqrt(variance), float(luminance.mean())


def allocate(deviation: np.ndarray, mean_luminance: float, unfinished: np.ndarray) -> np.ndarray:
    """Probabilities (rows,columns) of tiles by their deviation, if they, or others beside them, are unfinished."""
    rounding = SUM_ROUNDING * mean_luminance / MIN_TILE_PROBABILITY ** (1.0 / ALLOCATION_EXPONENT)
    always = max(float(np.quantile(deviation[unfinished], 1.0 - ALWAYS_SAMPLED_FRACTION)), rounding, FLOAT32_TINY)
    probability = np.where(unfinished, deviation / always, 0.0) ** ALLOCATION_EXPONENT
    probability = np.maximum(probability, MIN_NEIGHBOUR_RATIO * neighbourhood_max(probability))
    return np.clip(probability, MIN_TILE_PROBABILITY, 1.0).astype(np.float32)


def neighbourhood_max(values: np.ndarray) -> np.ndarray:
    """(H,W): the largest of each one and its eight neighbours."""
    padded = np.pad(values, 1, mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, (3, 3)).max((2, 3))
