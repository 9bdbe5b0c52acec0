# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials to a base colour or an image: what a Principled or a Diffuse BSDF is coloured with."""

import bpy
import numpy as np

from ..scene import Image, Materials
from . import images, nodes
from .findings import Findings

#: The colour of what has no material, as in Blender.
GREY = 0.8

#: The shaders that are drawn, and the socket of their colour.
SHADERS = {"ShaderNodeBsdfPrincipled": "Base Color", "ShaderNodeBsdfDiffuse": "Color"}


class MaterialTable:
    """Gives each material and each image its index, and reads it when it is first met."""

    def __init__(self, findings: Findings) -> None:
        self._findings = findings
        self._indices: dict[int, int] = {}
        self._rows: list[tuple[np.ndarray, int]] = []
        self._image_indices: dict[tuple[int, bool, bool], int] = {}
        self._images: list[Image] = []

    def index(self, material: bpy.types.Material | None) -> int:
        """Of a material in `table`; None is the grey of what has no material."""
        key = material.as_pointer() if material else 0
        if key not in self._indices:
            self._indices[key] = len(self._rows)
            self._rows.append(self._row(material) if material else (np.full(3, GREY), -1))
        return self._indices[key]

    def table(self) -> Materials:
        """All that were met."""
        return Materials(
            base_color=np.array([color for color, _ in self._rows], np.float32).reshape(-1, 3),
            image=np.array([image for _, image in self._rows], np.int32),
        )

    def images(self) -> tuple[Image, ...]:
        """What Materials.image leads into."""
        return tuple(self._images)

    def _row(self, material: bpy.types.Material) -> tuple[np.ndarray, int]:
        """Base colour (3,) and image."""
        node_tree = nodes.tree(material)
        if node_tree is None:
            return nodes.color(material.diffuse_color, GREY), -1
        shader = nodes.surface(node_tree)
        if shader is None:
            return np.zeros(3), -1
        if shader.bl_idname not in SHADERS:
            kind = f"Materials whose surface is a node '{shader.bl_label}' are drawn in their viewport colour"
            self._findings.note(kind, material.name)
            return nodes.color(material.diffuse_color, GREY), -1
        return self._colored(material, shader.inputs[SHADERS[shader.bl_idname]])

    def _colored(self, material: bpy.types.Material, socket: bpy.types.NodeSocket) -> tuple[np.ndarray, int]:
        """Base colour and image of a shader's colour socket."""
        plain = nodes.color(socket.default_value, GREY)
        fed_by = nodes.source(socket)
        if fed_by is None:
            return plain, -1
        node = fed_by.node
        if node.bl_idname == "ShaderNodeRGB":
            return nodes.color(fed_by.default_value, GREY), -1
        if node.bl_idname == "ShaderNodeTexImage" and fed_by.identifier == "Color":
            return plain, self._image(material, node)
        kind = f"Materials coloured by a node '{node.bl_label}' are drawn in the plain colour of its socket"
        self._findings.note(kind, material.name)
        return plain, -1

    def _image(self, material: bpy.types.Material, node: bpy.types.ShaderNodeTexImage) -> int:
        """The node's image, -1 where there is none to read."""
        image = node.image
        if image is None:
            self._findings.note("Materials with an empty Image Texture are drawn in their base colour", material.name)
            return -1
        self._note_placement(material, node)
        repeat, on_black = node.extension == "REPEAT", not node.outputs["Alpha"].is_linked
        key = (image.as_pointer(), repeat, on_black)
        if key not in self._image_indices:
            self._image_indices[key] = self._read(image, repeat, on_black)
        return self._image_indices[key]

    def _read(self, image: bpy.types.Image, repeat: bool, on_black: bool) -> int:
        texels = images.texels(image, on_black)
        if texels is None:
            self._findings.note(
                "Images that are missing or cannot be read are left out, and the base colour is drawn", image.name
            )
            return -1
        if not images.is_known_space(image):
            self._findings.note("Images in a colour space that is not known are taken for sRGB", image.name)
        if image.source in ("TILED", "SEQUENCE", "MOVIE"):
            self._findings.note("Of image sequences, movies and tiled images one picture is drawn", image.name)
        self._images.append(Image(texels, repeat))
        return len(self._images) - 1

    def _note_placement(self, material: bpy.types.Material, node: bpy.types.ShaderNodeTexImage) -> None:
        """Say where a texture will not lie as the artist meant it."""
        placed_by = nodes.source(node.inputs["Vector"])
        if placed_by is not None and (placed_by.node.bl_idname, placed_by.name) not in nodes.UV_OUTPUTS:
            kind = f"Textures placed by a node '{placed_by.node.bl_label}' lie on the active UV map as it is"
            self._findings.note(kind, material.name)
        if node.projection != "FLAT":
            self._findings.note("Textures projected otherwise than flat lie on the active UV map", material.name)
        if node.extension not in ("REPEAT", "EXTEND"):
            kind = "Textures that are clipped or mirrored at their border have the border's colour there"
            self._findings.note(kind, material.name)
