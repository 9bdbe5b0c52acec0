# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads materials: the values of their inputs, their graphs, and the light that they emit."""

from typing import Any, NamedTuple

import bpy
import numpy as np

from ....color import luminance
from ....scene import MATERIAL_INPUTS, Materials, NodeGraph
from ..diagnostics import Diagnostics
from ..geometry.instance_attributes import InstanceAttribute
from ..geometry.needs import NOTHING, Needs
from ..node_graphs.converters import CONVERTERS
from ..node_graphs.normal_nodes import displaced_normal
from ..node_graphs.reader import GraphReader, Ray
from . import images, nodes, unsupported_features
from .default_material import default_reflection
from .image_reader import ImageReader
from .surface import Emission, Surface
from .transparency import Transparency

#: The only input that an image may give.
COLOR = "base_color"

#: Default values of the inputs and of the emission.
DEFAULTS: dict[str, Any] = {
    name: [each.default] * each.components if each.components > 1 else each.default
    for name, each in MATERIAL_INPUTS.items()
} | {"emission": [0.0, 0.0, 0.0]}
#: Of materials that reflect nothing.
BLACK: dict[str, Any] = {**DEFAULTS, COLOR: [0.0, 0.0, 0.0]}

NO_CONSTANTS = np.zeros((0, 4), np.float32)


class _Row(NamedTuple):
    """One row of Materials."""

    values: dict[str, Any]  # as DEFAULTS
    image: int = -1
    graph: NodeGraph | None = None
    constants: np.ndarray = NO_CONSTANTS  # of the graph
    #: For camera rays and for shadow rays; None: nothing passes.
    transparency: tuple[Transparency | None, Transparency | None] = (None, None)
    emission: Emission | None = None  # that varies
    needs: Needs = NOTHING
    images: frozenset[int] = frozenset()  # that it or its graph uses
    findings: tuple[Diagnostics, ...] = ()  # those of an image are shared by all materials that use the image

    @property
    def graphs(self) -> tuple[NodeGraph | None, ...]:
        """Those of the surface, of its transparency and of its emission."""
        return self.graph, *(None if each is None else each.graph for each in (*self.transparency, self.emission))

    @property
    def all_constants(self) -> tuple[np.ndarray, ...]:
        """Those of `graphs`."""
        others = (NO_CONSTANTS if each is None else each.constants for each in (*self.transparency, self.emission))
        return self.constants, *others


UNUSED_ROW = _Row(DEFAULTS)
GREY_ROW = _Row(DEFAULTS, *default_reflection()[1:])


class MaterialReader:
    """Reads materials on first use. The index of a material never changes."""

    def __init__(self, image_reader: ImageReader) -> None:
        self._images = image_reader
        self._images.users.append(self._used_images)
        #: Attributes of instances that any material has ever read: their indices never change.
        self.instance_attributes: dict[InstanceAttribute, int] = {}
        self._indices: dict[int, int] = {}
        self._rows: list[_Row | None] = []
        self._used: set[int] = set()

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

    def needs(self, index: int) -> Needs:
        """What a material needs of meshes."""
        return (self._rows[index] or UNUSED_ROW).needs

    @property
    def reads_view_layer(self) -> bool:
        """Whether any material has ever read attributes of the view layer, which may be those of the world."""
        return any(each.type == "VIEW_LAYER" for each in self.instance_attributes)

    def update(self, material: bpy.types.Material) -> bool:
        """Read a changed material again, if it has been used. Whether it needs something else of meshes now."""
        index = self._indices.get(material.original.session_uid)
        if index is None:
            return False
        last, self._rows[index] = self._rows[index], None
        row = self._rows[index] = self._changed_row(material, last)
        return last is not None and last.needs != row.needs

    def forget(self) -> None:
        """Some image has changed: read all materials again when they are next requested."""
        self._rows = [None] * len(self._rows)

    def table(self, findings: Diagnostics) -> Materials:
        """All materials that have ever been used: their indices never change."""
        rows = [(index in self._used and row) or UNUSED_ROW for index, row in enumerate(self._rows)]
        for each in dict.fromkeys(each for row in rows for each in row.findings):
            findings.merge(each)
        graphs = self.graphs()
        constants = [each for row in rows for each in row.all_constants]
        counts = np.array([len(each) for each in constants], np.int64)
        first = np.where(counts > 0, np.cumsum(counts) - counts, -1).reshape(len(rows), 4)
        indices = np.array([[-1 if each is None else graphs.index(each) for each in row.graphs] for row in rows])
        indices = indices.reshape(len(rows), 4)
        passes = slice(None if (indices[:, 1:3] >= 0).any() else 0)
        varies = slice(None if (indices[:, 3] >= 0).any() else 0)
        values = {name: [row.values[name] for row in rows] for name in DEFAULTS}
        return Materials.of(
            **values,
            image=[row.image for row in rows],
            graph=indices[:, 0],
            first_constant=first[:, 0],
            constants=np.concatenate([NO_CONSTANTS, *constants]),
            transparency=indices[passes, 1:3],
            transparency_constant=first[passes, 1:3],
            emission_graph=indices[varies, 3],
            emission_constant=first[varies, 3],
        )

    def graphs(self) -> tuple[NodeGraph, ...]:
        """The graphs that Materials has indices of."""
        rows = (self._rows[index] or UNUSED_ROW for index in sorted(self._used))
        return tuple(dict.fromkeys(graph for row in rows for graph in row.graphs if graph is not None))

    def _used_images(self) -> frozenset[int]:
        return frozenset[int]().union(*(row.images for row in self._rows if row is not None))

    def _changed_row(self, material: bpy.types.Material, last: _Row | None) -> _Row:
        """The row of a material that has changed.

        While a slider is dragged, the graph has to stay the same: a new one takes time to compile. So if the simplest
        graph is another one than before, the graph is not simplified, and will stay the same from now on.
        """
        row = self._row(material)
        if last is None or row.graphs == last.graphs:
            return row
        return self._row(material, simplify=False)

    def _row(self, material: bpy.types.Material | None, simplify: bool = True) -> _Row:
        if material is None:
            return GREY_ROW
        findings = Diagnostics()
        node_tree = nodes.tree(material)
        if node_tree is None:
            viewport_color = nodes.color(material.diffuse_color, MATERIAL_INPUTS[COLOR].default)
            return _Row({**DEFAULTS, COLOR: viewport_color}, findings=(findings,))
        output = nodes.output(node_tree)
        unsupported_features.warn_of_output(material, output, findings)
        used_images: dict[int, Diagnostics] = {}
        reader = GraphReader(
            CONVERTERS,
            material,
            self.instance_attributes,
            lambda node: self._image(material, node, findings, used_images),
            luminance(images.working_space()),
            simplify,
        )
        if output is not None:
            reader.displaced_normal = displaced_normal(reader, output)
        closures = reader.surface(output)
        if not closures:
            findings.warn("Materials without a surface are drawn black", material.name)
            return _Row(BLACK, findings=(findings,))
        for closure in closures:
            unsupported_features.warn_of_shader(material, closure.node, findings)
        surface = Surface(reader, closures, self._images.mean_texel)
        reflection = surface.reflection(findings)
        shadow = camera = surface.transparency(closures, findings)
        if not material.use_transparent_shadow:
            shadow = None
        elif reader.depends_on_ray:
            shadow = surface.transparency(reader.surface(output, Ray.SHADOW), findings)
        emission = surface.emission(findings)
        every = (each for each in (reflection, camera, shadow, emission) if each is not None)
        graphs = [each.graph for each in every if each.graph is not None]
        needs = NOTHING
        if graphs:
            reads_objects = any(graph.reads_objects for graph in graphs)
            needs = Needs(reader.uv_layer, tuple(reader.attributes), reads_objects, tuple(reader.instance_attributes))
        elif reflection.image >= 0:
            needs = Needs(reader.uv_layer)
        values = DEFAULTS | {COLOR: reflection.base_color, "emission": emission.radiance}
        return _Row(
            values,
            reflection.image,
            reflection.graph,
            reflection.constants,
            (camera, shadow),
            emission,
            needs,
            frozenset(used_images),
            (findings, *used_images.values()),
        )

    def _image(
        self,
        material: bpy.types.Material,
        node: bpy.types.ShaderNodeTexImage,
        findings: Diagnostics,
        used_images: dict[int, Diagnostics],
    ) -> int:
        """The index of a node's image; -1 if it has none. Adds the index and the issues of the image."""
        image = node.image
        if image is None:
            findings.warn("Image Textures without an image are magenta, as in Blender", material.name)
            return -1
        unsupported_features.warn_of_mapping(material, node, findings)
        repeat, on_black = node.extension == "REPEAT", not node.outputs["Alpha"].is_linked
        index, issues = self._images.index_of(image, node.image_user, repeat, on_black)
        used_images[index] = issues
        return index
