# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads render passes back from targets. Their values are in world space."""

from collections.abc import Callable

import numpy as np

from ..render_passes import RenderPass
from ..resource_types import Target
from ..resources import BACKGROUND_DEPTH, DEPTH, NORMAL, POSITION
from .gl.render_targets import RenderTargets
from .gl.shader_records import OCTAHEDRON_STEPS, directions_from_octahedron

#: Functions that decode texels (N,C) of surfaces, given the anchor (3,). Texels of other targets need no decoding.
DECODERS: dict[Target, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    NORMAL: lambda texels, _anchor: directions_from_octahedron(
        np.ascontiguousarray(texels[:, :1]).view(np.int16) / OCTAHEDRON_STEPS
    ),
    POSITION: lambda texels, anchor: texels[:, :3] + anchor,
}


def image(targets: RenderTargets, render_pass: RenderPass, anchor: np.ndarray) -> np.ndarray:
    """(H,W,channels) float32, bottom row first; 0 in the background."""
    texels = targets.read(render_pass.resource)
    if render_pass.resource not in DECODERS:
        return np.ascontiguousarray(texels[..., : len(render_pass.channels)])
    values = np.zeros((*texels.shape[:2], len(render_pass.channels)), np.float32)
    visible = targets.read(DEPTH)[..., 0] < BACKGROUND_DEPTH
    values[visible] = DECODERS[render_pass.resource](texels[visible], anchor)
    return values
