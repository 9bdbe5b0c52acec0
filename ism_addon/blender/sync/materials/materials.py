# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads materials: the values of their inputs, the image of the base colour, and the light that they emit."""

from typing import Any, NamedTuple

import bpy
import numpy as np

from ....scene import MATERIAL_INPUTS, Image, Materials
from ..diagnostics import Diagnostics
from . import emission, images, nodes, unsupported_features

#: The session_uid of an image, whether it repeats, whether it is on black, and the file of a sequence's frame or "".
ImageKey = tuple[int, bool, bool, str]

#: The only input that an image may give.
COLOR = "base_color"

#: Default values of the inputs and of the emission.
DEFAULTS: dict[str, Any] = {
    name: [each.default] * each.components if each.components > 1 else each.default
    for name, each in MATERIAL_INPUTS.items()
} | {"emission": [0.0, 0.0, 0.0]}
#: Of materials that reflect nothing.
BLACK: dict[str, Any] = {**DEFAULTS, COLOR: [0.0, 0.0, 0.0]}


class _Row(NamedTuple):
    """One row of Materials."""

    values: dict[str, Any]  # as DEFAULTS
    image: int
    layer: str | None  # the UV layer of its image; "": the one that renders; None without an image
    findings: tuple[Diagnostics, ...]  # those of its image are shared by all materials that use the image


GREY_ROW = _Row(DEFAULTS, -1, None, ())


class MaterialReader:
    """Reads materials and images on first use. The index of a material never changes."""

    def __init__(self) -> None:
        self._indices: dict[int, int] = {}
        self._rows: list[_Row | None] = []
        self._used: set[int] = set()
        self._read_images: dict[ImageKey, tuple[int, Diagnostics]] = {}
        self._images: list[Image] = []
        #: Images by the same keys, with their origin: they are read again only if that has changed.
        self._image_cache: dict[ImageKey, tuple[tuple, Image]] = {}
        #: Mean colors of images that are emitted, by session_uid.
        self._mean_colors: dict[int, np.ndarray | None] = {}

    def reset(self) -> None:
        """To be called before the materials of all instances are requested."""
        self._used.clear()

    def index(self, material: bpy.types.Material | None) -> int:
        """The row of a material in `table`; None stands for the grey of objects without a material."""
        key = material.original.session_uid if material else 0
        index = self._indices.setdefault(key, len(self._rows))
        if index == len(self._rows):
            self._rows.append(None)
        if self._rows[index] is None:
            self._rows[index] = self._row(material)
        self._used.add(index)
        return index

    def uv_layer(self, index: int) -> str | None:
        """The UV layer of a material's image; "": the one that renders; None without an image."""
        return (self._rows[index] or GREY_ROW).layer

    def update(self, material: bpy.types.Material) -> bool:
        """Read a changed material again, if it has been used. Whether it has another UV layer now."""
        index = self._indices.get(material.original.session_uid)
        if index is None:
            return False
        last, self._rows[index] = self._rows[index], None
        row = self._rows[index] = self._row(material)
        return last is not None and last.layer != row.layer

    def forget_images(self) -> None:
        """Some image has changed: read all materials again when they are next requested."""
        self._rows = [None] * len(self._rows)
        if self._read_images:  # otherwise nothing has been read since the last call
            self._image_cache = {key: cached for key, cached in self._image_cache.items() if key in self._read_images}
        self._read_images.clear()
        self._images.clear()
        self._mean_colors.clear()

    def table(self, findings: Diagnostics) -> Materials:
        """All materials that have ever been used: their indices never change."""
        rows = [row or GREY_ROW for row in self._rows]
        for each in dict.fromkeys(each for index in sorted(self._used) for each in rows[index].findings):
            findings.merge(each)
        return Materials.of_rows({**row.values, "image": row.image} for row in rows)

    def images(self) -> tuple[Image, ...]:
        """The images that Materials.image has indices of."""
        return tuple(self._images)

    def _row(self, material: bpy.types.Material | None) -> _Row:
        if material is None:
            return GREY_ROW
        findings = Diagnostics()
        node_tree = nodes.tree(material)
        if node_tree is None:
            return _Row(self._viewport_values(material), -1, None, (findings,))
        output = nodes.output(node_tree)
        unsupported_features.warn_of_output(material, output, findings)
        shader = nodes.surface(output)
        if shader is None:
            findings.warn("Materials without a surface are drawn black", material.name)
            return _Row(BLACK, -1, None, (findings,))
        radiance = emission.read(shader, self._mean_color, material.name, findings)
        if shader.bl_idname == emission.EMISSION:
            return _Row({**BLACK, "emission": radiance}, -1, None, (findings,))
        if shader.bl_idname not in MATERIAL_INPUTS[COLOR].sockets:
            issue = f"Materials whose surface is a node '{shader.bl_label}' are drawn in their viewport colour"
            findings.warn(issue, material.name)
            return _Row(self._viewport_values(material), -1, None, (findings,))
        unsupported_features.warn_of_shader(material, shader, findings)
        return self._row_of_shader(material, shader, radiance, findings)

    @staticmethod
    def _viewport_values(material: bpy.types.Material) -> dict[str, Any]:
        """Values of the inputs, with the material's viewport colour as base colour."""
        return {**DEFAULTS, COLOR: nodes.color(material.diffuse_color, MATERIAL_INPUTS[COLOR].default)}

    def _row_of_shader(
        self, material: bpy.types.Material, shader: bpy.types.Node, radiance: np.ndarray, findings: Diagnostics
    ) -> _Row:
        """A row with the values of a shader's sockets, which emits this radiance (3,)."""
        values, image, layer, image_findings = {**DEFAULTS, "emission": radiance}, -1, None, Diagnostics()
        for name, each in MATERIAL_INPUTS.items():
            if (socket := shader.inputs.get(each.sockets.get(shader.bl_idname, ""))) is None:
                continue
            values[name], node = nodes.value(socket, each.default)
            source = nodes.source(socket)
            if node is None or source is None:
                continue
            if name == COLOR and node.bl_idname == "ShaderNodeTexImage" and source.identifier == "Color":
                image, image_findings = self._image(material, node, findings)
                layer = nodes.uv_layer(node.inputs["Vector"]) if image >= 0 else None
                continue
            issue = f"Materials whose {socket.name} is given by a node '{node.bl_label}' have the socket's own value"
            findings.warn(issue, material.name)
        return _Row(values, image, layer, (findings, image_findings))

    def _mean_color(self, image: bpy.types.Image) -> np.ndarray | None:
        """See emission.MeanColor; computed once."""
        uid = image.original.session_uid
        if uid not in self._mean_colors:
            self._mean_colors[uid] = images.mean_color(image)
        return self._mean_colors[uid]

    def _image(
        self, material: bpy.types.Material, node: bpy.types.ShaderNodeTexImage, findings: Diagnostics
    ) -> tuple[int, Diagnostics]:
        """The index of the node's image, -1 if it cannot be read, and the issues of the image."""
        image = node.image
        if image is None:
            findings.warn("Materials with an empty Image Texture are drawn in their base colour", material.name)
            return -1, Diagnostics()
        unsupported_features.warn_of_mapping(material, node, findings)
        repeat, on_black = node.extension == "REPEAT", not node.outputs["Alpha"].is_linked
        path = image.filepath_from_user(image_user=node.image_user) if image.source == "SEQUENCE" else ""
        key = (image.original.session_uid, repeat, on_black, path)
        if key not in self._read_images:
            self._read_images[key] = self._read_image(key, image)
        return self._read_images[key]

    def _read_image(self, key: ImageKey, image: bpy.types.Image) -> tuple[int, Diagnostics]:
        findings = Diagnostics()
        loaded = self._load(key, image)
        if loaded is None:
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
        index = self._free_index()
        self._images[index:] = [loaded, *self._images[index + 1 :]]
        return index, findings

    def _free_index(self) -> int:
        """The index of a frame of an image sequence that no material uses any more; otherwise a new index."""
        used = {row.image for row in self._rows if row is not None}
        for key, (index, _) in self._read_images.items():
            if key[-1] and index >= 0 and index not in used:
                del self._read_images[key]
                return index
        return len(self._images)

    def _load(self, key: ImageKey, image: bpy.types.Image) -> Image | None:
        """An image's texels: those read last time, if the origin is the same."""
        _, repeat, on_black, path = key
        origin, cached = images.origin(image.original), self._image_cache.pop(key, None)
        if cached is None or origin is None or cached[0] != origin:
            texels = images.texels_of_frame(image, path, on_black) if path else images.texels(image, on_black)
            if texels is None:
                return None
            loaded = Image(texels, repeat, images.encoding(image))
        else:
            loaded = cached[1]
        if origin is not None:
            self._image_cache[key] = origin, loaded
        return loaded
