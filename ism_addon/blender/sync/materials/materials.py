# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials to rows of their inputs, and the image that a Principled or a Diffuse BSDF is coloured with."""

from typing import Any, NamedTuple

import bpy

from ....scene import MATERIAL_INPUTS, Image, Materials
from ..diagnostics import Diagnostics
from . import images, nodes, unsupported_features

#: The session_uid of an image, whether it repeats and is on black, and the file of its sequence's frame.
ImageKey = tuple[int, bool, bool, str]

#: The input that an image may stand for.
COLOR = "base_color"

#: Values of inputs where nothing says others.
DEFAULTS: dict[str, Any] = {
    name: [each.default] * each.components if each.components > 1 else each.default
    for name, each in MATERIAL_INPUTS.items()
}


class _Row(NamedTuple):
    """One row of Materials."""

    values: dict[str, Any]  # of the inputs, by name
    image: int
    layer: str | None  # the UV layer that its image lies on; "": the one that renders; None where it has no image
    findings: tuple[Diagnostics, ...]  # those of its image are shared with the others that have it


GREY_ROW = _Row(DEFAULTS, -1, None, ())


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
        return Materials.of_rows({**row.values, "image": row.image} for row in rows)

    def images(self) -> tuple[Image, ...]:
        """What Materials.image leads into."""
        return tuple(self._images)

    def _row(self, material: bpy.types.Material | None) -> _Row:
        if material is None:
            return GREY_ROW
        findings = Diagnostics()
        node_tree = nodes.tree(material)
        if node_tree is None:
            return _Row(self._in_viewport(material), -1, None, (findings,))
        output = nodes.output(node_tree)
        unsupported_features.note_output(material, output, findings)
        shader = nodes.surface(output)
        if shader is None:
            findings.warn("Materials without a surface are drawn black", material.name)
            return _Row({**DEFAULTS, COLOR: [0.0, 0.0, 0.0]}, -1, None, (findings,))
        if shader.bl_idname not in MATERIAL_INPUTS[COLOR].sockets:
            issue = f"Materials whose surface is a node '{shader.bl_label}' are drawn in their viewport colour"
            findings.warn(issue, material.name)
            return _Row(self._in_viewport(material), -1, None, (findings,))
        unsupported_features.note_shader(material, shader, findings)
        return self._shaded(material, shader, findings)

    @staticmethod
    def _in_viewport(material: bpy.types.Material) -> dict[str, Any]:
        """Values of the inputs by its viewport color."""
        return {**DEFAULTS, COLOR: nodes.color(material.diffuse_color, MATERIAL_INPUTS[COLOR].default)}

    def _shaded(self, material: bpy.types.Material, shader: bpy.types.Node, findings: Diagnostics) -> _Row:
        """A row from a shader's sockets."""
        values, image, layer, of_image = dict(DEFAULTS), -1, None, Diagnostics()
        for name, each in MATERIAL_INPUTS.items():
            if (socket := shader.inputs.get(each.sockets.get(shader.bl_idname, ""))) is None:
                continue
            values[name], node = nodes.value(socket, each.default)
            source = nodes.source(socket)
            if node is None or source is None:
                continue
            if name == COLOR and node.bl_idname == "ShaderNodeTexImage" and source.identifier == "Color":
                image, of_image = self._image(material, node, findings)
                layer = nodes.uv_layer(node.inputs["Vector"]) if image >= 0 else None
                continue
            issue = f"Materials whose {socket.name} is given by a node '{node.bl_label}' have the socket's own value"
            findings.warn(issue, material.name)
        return _Row(values, image, layer, (findings, of_image))

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
            found = Image(texels, repeat, images.encoding(image))
        else:
            found = kept[1]
        if origin is not None:
            self._of_origin[key] = origin, found
        return found
