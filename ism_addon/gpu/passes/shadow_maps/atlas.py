# SPDX-License-Identifier: GPL-3.0-or-later
"""Layout of the shadow maps of many virtual lights in one texture, which several batches use in turn if necessary."""

from dataclasses import dataclass

import numpy as np

#: Sides of maps are multiples of this, so that pull-push can halve them (see fill_holes).
MAP_SIZE_MULTIPLE = 8

#: Limit of an atlas; more maps are drawn in further batches.
MAX_ATLAS_TEXELS = 1 << 24


@dataclass(frozen=True)
class Batch:
    """Virtual lights first … first + count - 1, whose maps of `side` texels lie in an atlas row by row."""

    first: int
    count: int
    side: int
    columns: int

    @property
    def size(self) -> tuple[int, int]:
        """Of the atlas, in texels."""
        return self.columns * self.side, -(-self.count // self.columns) * self.side

    def corner(self, index: int) -> tuple[int, int]:
        """The lower left texel of the batch's map number `index`."""
        return index % self.columns * self.side, index // self.columns * self.side


def batches(virtual_lights: int, map_size: int, texture_size: int) -> list[Batch]:
    """The fewest atlases, within the GL's texture size, with a map for each virtual light; at least one."""
    side = min(
        -(-map_size // MAP_SIZE_MULTIPLE) * MAP_SIZE_MULTIPLE, texture_size // MAP_SIZE_MULTIPLE * MAP_SIZE_MULTIPLE
    )
    max_columns = max(1, min(texture_size, int(MAX_ATLAS_TEXELS**0.5)) // side)
    max_count = max_columns * max_columns
    result = []
    for first in range(0, max(virtual_lights, 1), max_count):
        count = min(max_count, virtual_lights - first)
        result.append(Batch(first, count, side, max(1, min(max_columns, int(np.ceil(np.sqrt(count)))))))
    return result
