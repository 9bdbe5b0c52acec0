# SPDX-License-Identifier: GPL-3.0-or-later
"""Which parts of the picture a sample is spent on: those that samples still change, and as much as they do.

After the first few samples, blocks of pixels take part with a chance by the standard deviation of their samples, so
that for a given number of pixels drawn the least error is left (Neyman 1934). A block is averaged over the samples that
it took part in. One whose error is below the threshold takes part only for the pixels of those beside it.
"""

from functools import cached_property

import moderngl
import numpy as np

from ....sampling import TURN_INCREMENTS, Dimension, members, sequence
from ....scene import Change
from ...convergence import Convergence
from ...frame import TILE_SIZE, Frame, Pass, from_tile_layout, tiles_where
from ...gl.render_targets import Target

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


class SelectTiles(Pass):
    """The blocks that take part in this sample, and in how many each did so far."""

    writes = {"noise": Target(2, "f4", divisor=TILE_SIZE, strips=True)}
    makes = ("blocks", "counts", "chances", "error")
    settings = ("shadow.method", "shortcuts")
    depends_on = (Change.VIEW, Change.SAMPLE)

    @cached_property
    def means(self) -> moderngl.VertexArray:
        return self.full_screen_program(tile_size=TILE_SIZE)

    def draw(self, frame: Frame) -> None:
        if frame.sample == 0:
            self.start(frame)
        elif frame.sample & (frame.sample - 1) == 0:  # as often as the number of samples has doubled
            noise, frame.tables["brightness"] = self.so_far(frame)
            unsettled = ~frame.tables["error"].settled
            if frame.fitted and frame.settings.shortcuts and frame.sample >= UNIFORM_SAMPLES and unsettled.any():
                self.allocate(noise, frame.tables["brightness"], unsettled)
        error, turn = frame.tables["error"], sequence(Dimension.TILE_TURN, frame.sample, 1)[0, 0]
        takes_part = (np.mod(self.phase + turn, 1.0) < self.chance) & neighbourhood_max(~error.settled)
        frame.tables["blocks"] = self.blocks(frame, takes_part)
        frame.counts["pixels_drawn"] += len(frame.tables["blocks"]) * TILE_SIZE**2
        self.turns += takes_part
        error.count(takes_part)
        of_blocks = 0, 0, *frame.blocks
        frame.tables["counts"].write(error.counts, of_blocks)
        frame.tables["chances"].write(np.stack([self.chance, self.chance * ~error.settled], 2), of_blocks)

    def start(self, frame: Frame) -> None:
        """All blocks, none drawn yet."""
        gl, (columns, rows) = self.device.gl, frame.blocks
        self.turns = np.zeros((rows, columns), np.float32)
        self.chance = np.ones((rows, columns), np.float32)
        self.phase = members(TURN_INCREMENTS[:1], 0, columns * rows).reshape(rows, columns)
        frame.tables["error"] = Convergence((rows, columns))
        for name, components in (("counts", 1), ("chances", 2)):
            frame.tables[name] = Target(components, "f4").create(gl, frame.blocks)

    def allocate(self, noise: np.ndarray, brightness: float, unsettled: np.ndarray) -> None:
        """Chances of blocks by their noise (H,W), if they, or others beside them, are not settled."""
        rounding = SUM_ROUNDING * brightness / MIN_TILE_PROBABILITY ** (1.0 / ALLOCATION_EXPONENT)
        enough = max(float(np.quantile(noise[unsettled], 1.0 - ALWAYS_SAMPLED_FRACTION)), rounding, FLOAT32_TINY)
        chance = np.where(unsettled, noise / enough, 0.0) ** ALLOCATION_EXPONENT
        chance = np.maximum(chance, MIN_NEIGHBOUR_RATIO * neighbourhood_max(chance))
        self.chance = np.clip(chance, MIN_TILE_PROBABILITY, 1.0).astype(np.float32)

    def blocks(self, frame: Frame, takes_part: np.ndarray) -> np.ndarray:
        """Rows of TILE. Each tile goes through the places in a pixel at its own pace."""
        blocks = tiles_where(takes_part)
        blocks["number"] = self.turns[takes_part]
        turn = blocks["number"].astype(np.int64) % len(frame.grid.places)
        blocks["texel"], blocks["place"] = frame.grid.texels[turn], frame.grid.places[turn]
        return blocks

    def so_far(self, frame: Frame) -> tuple[np.ndarray, float]:
        """Standard deviation (H,W) of the luminance of the blocks' samples, and the whole picture's mean luminance."""
        sums = {name: frame.targets[name] for name in ("sum", "sum_correction", "weights")}
        self.draw_per_tile(frame, frame.targets.into("noise"), self.means, **sums)
        self.device.wait()
        square, bright = np.moveaxis(from_tile_layout(frame.targets.read("noise"), frame.blocks), -1, 0)
        return np.sqrt(square), float(bright.mean())


def neighbourhood_max(values: np.ndarray) -> np.ndarray:
    """(H,W): the largest of each one and its eight neighbours."""
    padded = np.pad(values, 1, mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, (3, 3)).max((2, 3))
