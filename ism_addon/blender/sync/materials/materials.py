# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials to a base colour or an image: what a Principled or a Diffuse BSDF is coloured with."""

from typing import NamedTuple

import bpy
import numpy as np

from ....scene import Image, Materials
from ..diagnostics import Diagnostics
from . import images, nodes, unsupported_features

#: The session_uid of an image, whether it repeats and is on black, and the file of its sequence's frame.
ImageKey = tuple[int, bool, bool, str]

#: The colour of what has no material, as in Blender.
GREY = 0.8

#: The shaders that are drawn, and the socket of their colour.
SHADERS = {"ShaderNodeBsdfPrincipled": "Base Color", "ShaderNodeBsdfDiffuse": "Color"}


class _Row(NamedTuple):
    """One row of Materials."""

    base_color: np.ndarray
    image: int
    layer: str | None  # the UV layer that its image lies on; "": the one that renders; None where it has no image
    findings: tuple[Diagnostics, ...]  # those of its image are shared with the others that have it


GREY_ROW = _Row(np.full(3, GREY), -1, None, ())


class MaterialReader:
    """Gives each material and each image its index for good, and reads it when it is first met."""

    def __init__(self) -> None:
        self._indices: dict[int, int] = {}
        self._rows: list[_Row | None] = []
        self._met: set[int] = set()
        self._read_images: dict[ImageKey, tuple[int, Diagnostics]] = {}
        self._images: list[Image] = []
        #: By the same keys: those that need not be read again as long as their origin is the same.
        self._of_origin: dict[ImageKey, tuple[tuple, Image]] = {}

    def reset(self) -> None:
        """Before all materials of the scene are asked for anew."""
        self._met.clear()

    def index(self, material: bpy.types.Material | None) -> int:
        """Of a material in `table`; None is the grey of what has no material."""
        key = material.original.session_uid if material else 0
        index = self._indices.setdefault(key, len(self._rows))
        if index == len(self._rows):
            self._rows.append(None)
        if self._rows[index] is None:
            self._rows[index] = self._row(material)
        self._met.add(index)
        return index

    def uv_layer(self, index: int) -> str | None:
        """The UV layer that a material's image lies on; "": the one that renders; None where it has no image."""
        return (self._rows[index] or GREY_ROW).layer

    def update(self, material: bpy.types.Material) -> bool:
        """A material has changed; one that was never met is still none of ours. Whether it has another UV layer now."""
        index = self._indices.get(material.original.session_uid)
        if index is None:
            return False
        last, self._rows[index] = self._rows[index], None
        row = self._rows[index] = self._row(material)
        return last is not None and last.layer != row.layer

    def forget_images(self) -> None:
        """Some image has changed: all materials are to be read anew when they are next met."""
        self._rows = [None] * len(self._rows)
        if self._read_images:  # else nothing was read since the last time
            self._of_origin = {key: kept for key, kept in self._of_origin.items() if key in self._read_images}
        self._read_images.clear()
        self._images.clear()

    def table(self, findings: Diagnostics) -> Materials:
        """All that were ever met: their indices stay."""
        rows = [row or GREY_ROW for row in self._rows]
        for found in dict.fromkeys(found for index in sorted(self._met) for found in rows[index].findings):
            findings.merge(found)
        return Materials.of(base_color=[row.base_color for row in rows], image=[row.image for row in rows])

    def images(self) -> tuple[Image, ...]:
        """What Materials.image leads into."""
        return tuple(self._images)

    def _row(self, material: bpy.types.Material | None) -> _Row:
        if material is None:
            return GREY_ROW
        findings = Diagnostics()
        node_tree = nodes.tree(material)
        if node_tree is None:
            return _Row(nodes.color(material.diffuse_color, GREY), -1, None, (findings,))
        output = nodes.output(node_tree)
        unsupported_features.note_output(material, output, findings)
        shader = nodes.surface(output)
        if shader is None:
            findings.warn("Materials without a surface are drawn black", material.name)
            return _Row(np.zeros(3), -1, None, (findings,))
        if shader.bl_idname not in SHADERS:
            kind = f"Materials whose surface is a node '{shader.bl_label}' are drawn in their viewport colour"
            findings.warn(kind, material.name)
            return _Row(nodes.color(material.diffuse_color, GREY), -1, None, (findings,))
        unsupported_features.note_shader(material, shader, findings)
        return self._colored(material, shader.inputs[SHADERS[shader.bl_idname]], findings)

    def _colored(self, material: bpy.types.Material, socket: bpy.types.NodeSocket, findings: Diagnostics) -> _Row:
        """A row from a shader's colour socket."""
        plain, node = nodes.rgb(socket, GREY)
        if node is None:
            return _Row(plain, -1, None, (findings,))
        source = nodes.source(socket)
        if node.bl_idname == "ShaderNodeTexImage" and source is not None and source.identifier == "Color":
            index, of_image = self._image(material, node, findings)
            layer = nodes.uv_layer(node.inputs["Vector"]) if index >= 0 else None
            return _Row(plain, index, layer, (findings, of_image))
        kind = f"Materials coloured by a node '{node.bl_label}' are drawn in the plain colour of its socket"
        findings.warn(kind, material.name)
        return _Row(plain, -1, None, (findings,))

    def _image(
        self, material: bpy.types.Material, node: bpy.types.ShaderNodeTexImage, findings: Diagnostics
    ) -> tuple[int, Diagnostics]:
        """The node's image, -1 where there is none to read, and what is to be said of it."""
        image = node.image
        if image is None:
            findings.warn("Materials with an empty Image Texture are drawn in their base colour", material.name)
            return -1, Diagnostics()
        unsupported_features.note_placement(material, node, findings)
        repeat, on_black = node.extension == "REPEAT", not node.outputs["Alpha"].is_linked
        of_frame = image.filepath_from_user(image_user=node.image_user) if image.source == "SEQUENCE" else ""
        key = (image.original.session_uid, repeat, on_black, of_frame)
        if key not in self._read_images:
            self._read_images[key] = self._read_image(key, image)
        return self._read_images[key]

    def _read_image(self, key: ImageKey, image: bpy.types.Image) -> tuple[int, Diagnostics]:
        findings = Diagnostics()
        found = self._texels(key, image)
        if found is None:
            findings.warn(
                "Images that are missing or cannot be read are left out, and the base colour is drawn", image.name
            )
            return -1, findings
        if not images.is_known_space(image):
            findings.warn("Images in a colour space that is not known are taken for sRGB", image.name)
        if image.source == "TILED":
            findings.warn("Of tiled images one tile is drawn", image.name)
        if image.source == "MOVIE":
            findings.warn("Of movies one frame is drawn", image.name)
        index = self._frame_gone()
        self._images[index:] = [found, *self._images[index + 1 :]]
        return index, findings

    def _frame_gone(self) -> int:
        """The index of an image whose frame of its sequence no material shows any more; else a new one."""
        shown = {row.image for row in self._rows if row is not None}
        for key, (index, _) in self._read_images.items():
            if key[-1] and index >= 0 and index not in shown:
                del self._read_images[key]
                return index
        return len(self._images)

    def _texels(self, key: ImageKey, image: bpy.types.Image) -> Image | None:
        """Those of an image; that of the time before, where it has the same origin."""
        _, repeat, on_black, of_frame = key
        origin, kept = images.origin(image.original), self._of_origin.pop(key, None)
        if kept is None or origin is None or kept[0] != origin:
            texels = images.texels_of_frame(image, of_frame, on_black) if of_frame else images.texels(image, on_black)
            if texels is None:
                return None
            found = Image(texels, repeat)
        else:
            found = kept[1]
        if origin is not None:
            self._of_origin[key] = origin, found
        return found
