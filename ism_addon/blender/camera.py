# SPDX-License-Identifier: GPL-3.0-or-later
"""The final render's and the viewport's View, from Blender's own projection matrices."""

import bpy
import numpy as np

from ..scene import View

#: The cameras whose picture a matrix can describe.
DRAWABLE = ("PERSP", "ORTHO")


class CameraError(Exception):
    """No picture can be taken: the message is one sentence for the artist."""


def final_view(depsgraph: bpy.types.Depsgraph, engine: bpy.types.RenderEngine | None = None) -> View:
    """What the scene's active camera sees of the picture's border region, at the render's percentage.

    The engine, where there is one, knows the stereo view that is being rendered and its camera's place.
    Raises CameraError without a camera that can be drawn.
    """
    raise NotImplementedError


def viewport_view(
    depsgraph: bpy.types.Depsgraph,
    region_data: bpy.types.RegionView3D,
    width: int,
    height: int,
    camera: bpy.types.Object | None = None,
) -> View:
    """What a 3D viewport of width × height pixels shows; the camera is the one that it may look through.

    Raises CameraError if the viewport looks through a camera that cannot be drawn.
    """
    raise NotImplementedError
