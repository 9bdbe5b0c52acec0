# SPDX-License-Identifier: GPL-3.0-or-later
"""From the texels of a target to the values of a render pass, which are in world space."""

from collections.abc import Callable

import numpy as np

from ..render_passes import RenderPass
from ..resource_types import Target
from ..resources import BACKGROUND_DEPTH, DEPTH, NORMAL, POSITION
from .gl.render_targets import RenderTargets
from .gl.shader_records import directions_from_octahedron

#: What a target's texels (N,C) of surfaces stand for, given the anchor's origin (3,). Other targets hold the values.
DECODERS: dict[Target, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    NORMAL: lambda texels, _anchor: directions_from_octahedron(texels[:, :2]),
    POSITION: lambda texels, anchor: texels[:, :3] + anchor,
}


def image(targets: RenderTargets, wanted: RenderPass, anchor: np.ndarray) -> np.ndarray:
    """(H,W,channels) float32, bottom row first. Where nothing is seen, the texels are 0 and stay so."""
    texels = targets.read(wanted.resource)
    values = np.ascontiguousarray(texels[..., : len(wanted.channels)])
    if wanted.resource in DECODERS:
        seen = targets.read(DEPTH)[..., 0] < BACKGROUND_DEPTH
        values[seen] = DECODERS[wanted.resource](texels[seen], anchor)
    return values
