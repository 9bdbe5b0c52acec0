# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads Image Texture nodes of area and spot lights."""

import bpy
import numpy as np

from ...scene import LightImage
from ...scene.light_images import resampled
from .diagnostics import Diagnostics
from .materials import images, nodes

#: Texels along the longer side: larger images are resampled.
MAX_SIDE = 1024

#: Blender's types of lights whose images are drawn.
LIGHT_TYPES = "AREA", "SPOT"

#: Outputs of nodes that give a mesh's UVs unchanged: the node's type and the output's name.
UV_OUTPUTS = {("ShaderNodeUVMap", "UV"), ("ShaderNodeTexCoord", "UV")}


class LightImages:
    """The images of lights: the same objects for the same image and options until images change."""

    def __init__(self) -> None:
        self._found: dict[tuple, tuple[float, LightImage | None] | None] = {}

    def forget(self) -> None:
        """To be called when images have changed, before the lights are read again."""
        self._found.clear()

    def of_node(
        self, node: bpy.types.ShaderNodeTexImage, name: str, findings: Diagnostics
    ) -> tuple[float, LightImage | None]:
        """An image's largest value, and its colours if that is not 0; (1.0, None) if there is no image."""
        _warn_of_mapping(node, name, findings)
        image, found = node.image, None
        if image is not None:
            on_black, repeat = not node.outputs["Alpha"].is_linked, node.extension == "REPEAT"
            path = image.filepath_from_user(image_user=node.image_user) if image.source == "SEQUENCE" else ""
            key = image.original.session_uid, on_black, repeat, path
            if key not in self._found:
                self._found[key] = _read(image, on_black, repeat, path)
            found = self._found[key]
        if found is None:
            findings.warn("Lights whose Image Texture has no image, or one that cannot be read, are not coloured", name)
        return found or (1.0, None)


def _read(image: bpy.types.Image, on_black: bool, repeat: bool, path: str) -> tuple[float, LightImage | None] | None:
    """The largest value and the colours of an image, or of a sequence's file at `path`; None if it has no pixels."""
    loaded = images.read_frame(image, path, repeat, on_black) if path else images.read(image, repeat, on_black)
    if loaded is None:
        return None
    colors = images.linear(loaded)
    height, width = colors.shape[:2]
    if (scale := MAX_SIDE / max(height, width)) < 1.0:
        colors = resampled(colors, max(round(scale * height), 1), max(round(scale * width), 1))
    largest = float(colors.max())
    return largest, LightImage(np.clip(colors / largest, 0.0, 1.0), repeat) if largest else None


def _warn_of_mapping(node: bpy.types.ShaderNodeTexImage, name: str, findings: Diagnostics) -> None:
    """Warn of coordinates and options of an image that lights do not have."""
    vector, mapping = nodes.source(node.inputs["Vector"]), node.texture_mapping
    is_mapped = vector is not None and (vector.node.bl_idname, vector.name) not in UV_OUTPUTS
    is_mapped |= any(mapping.translation) or any(mapping.rotation) or tuple(mapping.scale) != (1.0, 1.0, 1.0)
    if is_mapped or node.projection != "FLAT":
        findings.warn("Images of lights that are mapped otherwise lie across the whole light", name)
    if node.interpolation == "Closest":
        findings.warn("Images of lights that are not interpolated are interpolated linearly", name)
