# SPDX-License-Identifier: GPL-3.0-or-later
"""What of some boxes is in a picture, slice by slice of its depth, as a box each. Boxes are (2,3,…): their corners."""

from itertools import pairwise

import numpy as np

from ...scene import View
from ...spaces import view_from_anchor
from ..gl.depth import planes
from ..gl.frame_uniforms import rays

#: Slices of the depth.
SLICES = 8

#: How much larger the boxes are than what is in them: rays start a little above curved surfaces, see rise.glsl.
MARGIN = 1.0 / 8.0

#: Pixels beyond the picture's border that samples may lie in.
BORDER = 1.0


def visible_slices(boxes: np.ndarray, view: View, anchor: np.ndarray) -> np.ndarray:
    """(2,3,K) float64, K ≤ SLICES: around all that is seen of boxes (2,3,N), anchor space."""
    from_anchor = view_from_anchor(view.view_from_world, anchor)
    ends = corners_of_slices(view, from_anchor, depths(boxes, view.clip_from_view, from_anchor))
    found = []
    for near, far in pairwise(ends):
        both = np.concatenate([near, far])
        low = np.maximum(boxes[0], both.min(0)[:, None])
        high = np.minimum(boxes[1], both.max(0)[:, None])
        there = (low <= high).all(0)
        if there.any():
            found.append((low[:, there].min(1), high[:, there].max(1)))
    low, high = np.array(found).reshape(-1, 2, 3).transpose(1, 2, 0)
    more = MARGIN * (high - low)
    return np.stack([low - more, high + more])


def depths(boxes: np.ndarray, clip_from_view: np.ndarray, from_anchor: np.ndarray) -> np.ndarray:
    """(SLICES + 1,) m along the view's axis: from the nearest of the boxes to the farthest."""
    middle, half = boxes.sum(0) / 2.0, (boxes[1] - boxes[0]) / 2.0
    depth, reach = -(from_anchor[2, :3] @ middle + from_anchor[2, 3]), np.abs(from_anchor[2, :3]) @ half
    nearest, farthest = (depth - reach).min(), (depth + reach).max()
    near_and_far = planes(clip_from_view)
    if near_and_far is None:
        return np.linspace(nearest, farthest, SLICES + 1)
    nearest = max(nearest, near_and_far[0])
    return np.geomspace(nearest, max(farthest, nearest), SLICES + 1)


def corners_of_slices(view: View, from_anchor: np.ndarray, depths: np.ndarray) -> np.ndarray:
    """(D,4,3) anchor space: the picture's corners at depths (D,)."""
    origins, directions = rays(view.clip_from_view, view.width, view.height)
    across, up = (-BORDER, view.width + BORDER), (-BORDER, view.height + BORDER)
    pixels = np.array([(1.0, x, y) for x in across for y in up])
    points = pixels @ origins + depths[:, None, None] * (pixels @ directions)
    return (points - from_anchor[:3, 3]) @ from_anchor[:3, :3]
