# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes' materials in Blender: Principled BSDFs that are Lambertian. Textures are packed into the file."""

from collections.abc import Callable

import bpy
import numpy as np

from tests.scenes.parts import textures
from tests.scenes.parts.textures import bordered, damask

RED = damask((0.47, 0.10, 0.085), (0.74, 0.46, 0.22))
GREEN = damask((0.13, 0.29, 0.21), (0.56, 0.58, 0.34), seed=52)
BLUE = damask((0.115, 0.20, 0.38), (0.70, 0.66, 0.52), seed=53)
GOLD = (0.78, 0.60, 0.30)

#: By name: the function that makes the texture, and the metres (across, up) that it covers.
TEXTURED: dict[str, tuple[Callable[[], np.ndarray], tuple[float, float]]] = {
    "Stone blocks": (textures.stone_blocks, (3.2, 3.2)),
    "Limestone": (textures.limestone, (2.0, 2.0)),
    "Paving": (textures.paving, (3.2, 3.2)),
    "Plaster": (textures.plaster, (3.0, 3.0)),
    "Oak": (textures.wood, (2.0, 1.0)),
    "Red damask": (lambda: RED, (0.8, 0.8)),
    "Green damask": (lambda: GREEN, (0.8, 0.8)),
    "Blue damask": (lambda: BLUE, (0.8, 0.8)),
    "Red banner": (lambda: bordered(RED, (3, 7), GOLD, (1024, 420)), (1.2, 3.0)),
    "Blue banner": (lambda: bordered(BLUE, (3, 7), GOLD, (1024, 420)), (1.2, 3.0)),
}

#: By name: linear colour.
PLAIN = {
    "Marble": (0.64, 0.61, 0.56),
    "Terracotta": (0.42, 0.17, 0.085),
    "Bronze": (0.16, 0.105, 0.055),
    "Paper": (0.72, 0.70, 0.66),
    "Clay": (0.55, 0.24, 0.16),
    "Ochre": (0.68, 0.45, 0.14),
    "Teal": (0.10, 0.36, 0.36),
    "Plum": (0.34, 0.13, 0.27),
    "Leaf": (0.20, 0.40, 0.10),
    "Grass": (0.28, 0.45, 0.12),
    "Earth": (0.30, 0.22, 0.15),
    "Iron": (0.22, 0.23, 0.25),
    "Bark": (0.34, 0.25, 0.18),
    "Concrete": (0.52, 0.51, 0.49),
    "Sandstone": (0.60, 0.44, 0.30),
}


class Materials:
    """The materials by name. Each is made at its first use."""

    def __init__(self) -> None:
        self.by_name: dict[str, bpy.types.Material] = {}

    def __getitem__(self, name: str) -> bpy.types.Material:
        if name not in self.by_name:
            self.by_name[name] = lambertian(name)
        return self.by_name[name]


def texture_size(name: str) -> tuple[float, float]:
    """Metres that one repeat of a material's texture covers."""
    return TEXTURED[name][1] if name in TEXTURED else (1.0, 1.0)


def lambertian(name: str) -> bpy.types.Material:
    """A Principled material without specular reflection. Its base colour is an image or constant."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    principled = material.node_tree.nodes["Principled BSDF"]
    principled.inputs["Specular IOR Level"].default_value = 0.0
    principled.inputs["Roughness"].default_value = 1.0
    if name in PLAIN:
        principled.inputs["Base Color"].default_value = (*PLAIN[name], 1.0)
        return material
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    texture.location = (-320, 300)
    texture.image = packed_image(name, TEXTURED[name][0]())
    material.node_tree.links.new(texture.outputs["Color"], principled.inputs["Base Color"])
    return material


def packed_image(name: str, pixels: np.ndarray, color_space: str = "sRGB") -> bpy.types.Image:
    """An image of pixels (H,W,3 or 4), bottom row first, kept inside the .blend."""
    height, width, channels = pixels.shape
    image = bpy.data.images.new(name, width, height, alpha=channels == 4)
    image.colorspace_settings.name = color_space
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :channels] = pixels
    image.pixels.foreach_set(rgba.ravel())
    image.pack()
    return image
