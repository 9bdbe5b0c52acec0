# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounding boxes of the visible scene, one for each slice of the frustum. Boxes are (2,3,…): low and high corners."""

from itertools import pairwise

import numpy as np

from ...scene import View
from ...spaces import view_from_anchor
from ..gl.depth import planes
from ..gl.frame_uniforms import rays

#: Slices of the frustum, by depth. See `dev.py bench constants` in docs/benchmarks.md.
SLICES = 8

#: Margin of the boxes, relative to their size: rays start above curved surfaces, see terminator_offset.glsl.
MARGIN = 1.0 / 8.0

#: Width of the border around the picture in which samples may lie. px
BORDER = 1.0


def visible_slices(boxes: np.ndarray, view: View, anchor: np.ndarray) -> np.ndarray:
    """(2,3,K) float64, K ≤ SLICES, anchor space: by slice, the bounding box of the visible parts of boxes (2,3,N)."""
    from_anchor = view_from_anchor(view.view_from_world, anchor)
    corners = corners_of_slices(view, from_anchor, depths(boxes, view.clip_from_view, from_anchor))
    slice_boxes = []
    for near, far in pairwise(corners):
        slice_corners = np.concatenate([near, far])
        low = np.maximum(boxes[0], slice_corners.min(0)[:, None])
        high = np.minimum(boxes[1], slice_corners.max(0)[:, None])
        overlaps = (low <= high).all(0)
        if overlaps.any():
            slice_boxes.append((low[:, overlaps].min(1), high[:, overlaps].max(1)))
    low, high = np.array(slice_boxes).reshape(-1, 2, 3).transpose(1, 2, 0)
    margin = MARGIN * (high - low)
    return np.stack([low - margin, high + margin])


def depths(boxes: np.ndarray, clip_from_view: np.ndarray, from_anchor: np.ndarray) -> np.ndarray:
    """(SLICES + 1,) m along the view's axis: borders of the slices, from the nearest box to the farthest."""
    centre, half = boxes.sum(0) / 2.0, (boxes[1] - boxes[0]) / 2.0
    depth, extent = -(from_anchor[2, :3] @ centre + from_anchor[2, 3]), np.abs(from_anchor[2, :3]) @ half
    nearest, farthest = (depth - extent).min(), (depth + extent).max()
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
