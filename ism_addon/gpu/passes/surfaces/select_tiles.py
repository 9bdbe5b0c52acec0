# SPDX-License-Identifier: GPL-3.0-or-later
"""Adaptive sampling: which tiles take part in a sample.

After the first samples, the probability of a tile follows the standard deviation of its samples, which minimises the
error for a given number of pixels (Neyman allocation, Neyman 1934). A tile's value is the mean of the samples in which
it took part. A converged tile takes part only for neighbours whose pixels its samples are filtered to.
"""

from dataclasses import dataclass
from functools import cached_property

import moderngl
import numpy as np

from ....resources import (
    CONVERGENCE,
    LIGHT_INFLUENCE,
    MEAN_LUMINANCE,
    SAMPLES_PER_TILE,
    SUM_COLOR,
    SUM_RESIDUAL,
    SUM_WEIGHTS,
    TILE_PROBABILITIES,
    TILE_SELECTION,
    TILE_SIZE,
    TILE_VARIANCE,
    TILES,
)
from ....sampling.dimensions import Dimension, draw
from ....scene import Change
from ...drawing import draw_per_tile
from ...frame import Frame, Pass, has_doubled, outputs
from ...tiles import from_strips, neighbourhood_max, relative_cost, tiles_where

#: Samples in which every tile takes part. See `dev.py bench constants` in docs/benchmarks.md.
UNIFORM_SAMPLES = 2

#: After the uniform samples: the minimum probability of a tile, and the fraction of tiles that have probability 1, if
#: there are many. See `dev.py bench constants` in docs/benchmarks.md. With twice that fraction, 16 samples of the
#: benchmark's kitchen, tree, products and lanterns take 1.3, 1.5, 1.2 and 1.1 times as long, for 1.0, 0.8, 1.0 and 1.0
#: of the error.
MIN_TILE_PROBABILITY = 0.06
ALWAYS_SAMPLED_FRACTION = 0.05

#: Minimum mean probability of all tiles. Where a few have nearly all of the variance, others would have hardly more
#: than the uniform samples. 16 samples of the benchmark's court draw a third more tiles, for 0.8 of the RMSE and 0.45
#: of the relative MSE.
MIN_MEAN_PROBABILITY = 0.25

#: Lights of a tile, on average, up to which that fraction of tiles has probability 1. With more lights the fraction
#: falls with a power of their number, so that a sample's time hardly grows. The minimum is inversely proportional to
#: their number. The benchmark's scene street has 25: it has the same error in .8 of the time. With a power of 1, 16
#: samples of it take a tenth longer.
FULL_RATE_LIGHTS = 8.0
FEWER_TILES_EXPONENT = 1.5

#: Draws of a tile, on average, from which on a new prediction of many lights' visibility pays. With fewer, predicting
#: takes longer than the rays that it saves. Street has 1.2 draws from the 9th to the 16th sample. With new predictions
#: for them, 16 samples take a tenth longer.
MIN_PREDICTED_DRAWS = 1.3

#: The variance of the mean of n samples is proportional to this power of 1 / n: samples are stratified, and most of
#: the variance is at edges (Mitchell 1996).
VARIANCE_EXPONENT = 1.5

#: For a given sum of n, the sum of deviation² / n^VARIANCE_EXPONENT is minimal if n is proportional to this power of
#: the deviation.
ALLOCATION_EXPONENT = 2.0 / (1.0 + VARIANCE_EXPONENT)

#: Minimum ratio of a tile's probability to a neighbour's. Its samples are filtered to the neighbour's pixels with the
#: inverse of the ratio as weight; large weights would make seams visible. See `dev.py bench constants`.
MIN_NEIGHBOUR_RATIO = 0.25

#: Standard deviation that rounding of float32 sums leaves where there is no noise, as a fraction of the mean luminance.
SUM_ROUNDING = 5e-4
FLOAT32_TINY = float(np.finfo(np.float32).tiny)

#: In tiles darker than the picture's mean, smaller changes are visible, in proportion to the root of the luminance, as
#: after display encoding, and as Cycles' adaptive sampling weights errors. So rays that change a pixel by less are
#: traced there. Below this fraction of the mean, as in tiles of it. With 0.5, what a sky lights in the shadow of its
#: sun has half as much error again after 16 samples. To draw dark tiles in more samples too leaves more error at bright
#: edges.
DARKEST = 0.1


@dataclass
class TileSelection:
    """How often each tile takes part: arrays (rows,columns) float32."""

    sample_counts: np.ndarray  # samples so far, including those of a converged tile for its neighbours
    probabilities: np.ndarray
    tolerance: np.ndarray  # of changes, see DARKEST
    excess_lights: float = 1.0  # lights of a tile, on average, over FULL_RATE_LIGHTS; at least 1

    def is_worth_predicting(self, sample: int) -> bool:
        """Whether enough draws would use new predictions, until the number of samples has doubled."""
        return self.excess_lights == 1.0 or sample * float(self.probabilities.mean()) >= MIN_PREDICTED_DRAWS


class SelectTiles(Pass):
    """The tiles that take part in this sample, and in how many samples each took part so far."""

    inputs = Change.VIEW, Change.SAMPLE, "shadow.method", "shortcuts"
    feedback = SUM_COLOR, SUM_RESIDUAL, SUM_WEIGHTS, CONVERGENCE, LIGHT_INFLUENCE
    outputs = outputs(
        *(TILES, TILE_SELECTION, SAMPLES_PER_TILE, TILE_PROBABILITIES, TILE_VARIANCE),
        MEAN_LUMINANCE,
    )

    @cached_property
    def variance(self) -> moderngl.VertexArray:
        return self.full_screen_program(tile_size=TILE_SIZE)

    def execute(self, frame: Frame) -> None:
        columns, rows = frame.tiles
        if frame.sample == 0 and frame.corrects:  # the same tiles, whose luminance is now known
            self.measure(frame)
            frame[TILES]["tolerance"] = frame[TILE_SELECTION].tolerance.ravel()
            return
        if frame.sample == 0:
            self.reset(frame)
        selection = frame[TILE_SELECTION]
        converged = np.zeros((rows, columns), bool) if frame.sample == 0 else frame[CONVERGENCE].converged
        if has_doubled(frame.sample):
            deviation = self.measure(frame)
            if frame.is_adaptive and frame.sample >= UNIFORM_SAMPLES and not converged.all():
                selection.excess_lights = max(lights_per_tile(frame) / FULL_RATE_LIGHTS, 1.0)
                selection.probabilities = allocate(
                    deviation, frame[MEAN_LUMINANCE], ~converged, selection.excess_lights
                )
        random = draw(Dimension.TILE_TURN, sample=frame.sample, tile=np.arange(columns * rows))
        takes_part = random.reshape(rows, columns) < selection.probabilities
        takes_part &= neighbourhood_max(~converged)
        frame[TILES] = self.tiles(frame, takes_part)
        frame.counts["pixels_drawn"] += len(frame[TILES]) * TILE_SIZE**2
        selection.sample_counts += takes_part
        frame[SAMPLES_PER_TILE] = frame[SAMPLES_PER_TILE] + (takes_part & ~converged)
        probabilities = np.stack([selection.probabilities, selection.probabilities * ~converged], 2)
        frame[TILE_PROBABILITIES].write(probabilities, (0, 0, columns, rows))

    @staticmethod
    def reset(frame: Frame) -> None:
        """Begin an image: each tile has probability 1 and no samples."""
        columns, rows = frame.tiles
        zeros, ones = (np.full((rows, columns), value, np.float32) for value in (0.0, 1.0))
        frame[TILE_SELECTION] = TileSelection(zeros, ones, ones)
        frame[SAMPLES_PER_TILE] = zeros.copy()

    @staticmethod
    def tiles(frame: Frame, takes_part: np.ndarray) -> np.ndarray:
        """Rows of TILE. The subpixel offset of a tile depends on how many samples it has had."""
        tiles = tiles_where(takes_part)
        tiles["sample_index"] = frame[TILE_SELECTION].sample_counts[takes_part]
        tiles["tolerance"] = frame[TILE_SELECTION].tolerance[takes_part]
        grid = frame.grid
        index = tiles["sample_index"].astype(np.int64) % len(grid.subpixel_offsets)
        tiles["visibility_texel"], tiles["subpixel_offset"] = grid.texels[index], grid.subpixel_offsets[index]
        return tiles

    def measure(self, frame: Frame) -> np.ndarray:
        """(rows,columns): see tile_statistics. Updates what depends on the luminance."""
        deviation, luminance = self.tile_statistics(frame)
        frame[MEAN_LUMINANCE] = float(luminance.mean())
        frame[TILE_SELECTION].tolerance = tolerance(luminance)
        return deviation

    def tile_statistics(self, frame: Frame) -> tuple[np.ndarray, np.ndarray]:
        """(rows,columns) each: standard deviation of the luminance of a tile's samples, and the mean luminance."""
        sums = {"sum_color": frame[SUM_COLOR], "sum_residual": frame[SUM_RESIDUAL], "sum_weights": frame[SUM_WEIGHTS]}
        self.device.overwrite()
        draw_per_tile(frame, frame.framebuffer(TILE_VARIANCE), self.variance, **sums)
        self.device.wait()
        texels = from_strips(frame.read(TILE_VARIANCE), frame.tiles)
        variance, luminance = np.moveaxis(texels, -1, 0)
        return np.sqrt(variance), luminance


def lights_per_tile(frame: Frame) -> float:
    """How many lights have a prediction at each pixel of a tile, on average."""
    influences = (frame.get(LIGHT_INFLUENCE) or {}).values()
    drawn = (each.contributes & ~each.is_faint & (each.coarse_visibility > 0.0) for each in influences)
    return sum(float(tiles.mean()) for tiles in drawn)


def tolerance(luminance: np.ndarray) -> np.ndarray:
    """(rows,columns): changes that are as visible as 1 where the luminance (rows,columns) is the mean."""
    return np.sqrt(np.clip(luminance / max(float(luminance.mean()), FLOAT32_TINY), DARKEST, 1.0))


def allocate(deviation: np.ndarray, mean_luminance: float, unconverged: np.ndarray, excess_lights: float) -> np.ndarray:
    """Probabilities (rows,columns) of tiles from their deviations; minimal in converged neighbourhoods."""
    fewer = excess_lights**-FEWER_TILES_EXPONENT
    minimum = MIN_TILE_PROBABILITY / excess_lights
    rounding = SUM_ROUNDING * mean_luminance / minimum ** (1.0 / ALLOCATION_EXPONENT)
    quantile = float(np.quantile(deviation[unconverged], 1.0 - fewer * always_sampled_fraction(deviation.size)))
    quantile = min(quantile, deviation_for_mean(deviation[unconverged], fewer * MIN_MEAN_PROBABILITY))
    reference_deviation = max(quantile, rounding, FLOAT32_TINY)  # of tiles with probability 1
    probability = np.where(unconverged, deviation / reference_deviation, 0.0) ** ALLOCATION_EXPONENT
    probability = np.maximum(probability, MIN_NEIGHBOUR_RATIO * neighbourhood_max(probability))
    return np.clip(probability, minimum, 1.0).astype(np.float32)


def deviation_for_mean(deviation: np.ndarray, mean: float) -> float:
    """The largest of deviations (N,) that gives at least this mean probability, if tiles of it have probability 1."""
    ordered = np.sort(deviation)
    powers = ordered.astype(np.float64) ** ALLOCATION_EXPONENT
    of_smaller = np.divide(np.cumsum(powers), powers, where=powers > 0.0, out=np.ones_like(powers))
    total = of_smaller + np.arange(len(powers) - 1, -1, -1)  # of all probabilities, by that deviation: it falls from N
    return float(ordered[np.count_nonzero(total >= mean * len(powers)) - 1])


def always_sampled_fraction(tiles: int) -> float:
    """The fraction of a picture's tiles that have probability 1 under few lights: larger in small pictures."""
    return min(ALWAYS_SAMPLED_FRACTION * relative_cost(tiles), 1.0)
