# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of instances that geometry nodes make, beside Cycles."""

import bpy
import numpy as np
import pytest

from tests.scenes.parts.geometry_nodes import GeometryNodes, on_points

from .squares import assert_as_in_cycles, centres, ours, see

IS_KNOWN = hasattr(bpy.types.Object, "evaluated_geometry")
needs_geometries = pytest.mark.skipif(not IS_KNOWN, reason="Blender 4.5 is the first in which Python reads instances")


@needs_geometries
def test_attributes_of_instances_that_geometry_nodes_make(device, hidden, add):
    names = ["number", "whole", "flag", "pair", "vector", "color", "turn", "second", "missing"]
    row = add("row", ([], []))
    nodes = GeometryNodes(row)
    points = nodes.points(4, (1.0, 0.0, 0.0))
    points = nodes.stored(points, "number", "FLOAT", nodes.index(0.1, 0.2))
    points = nodes.stored(points, "whole", "INT", nodes.index(1.0))
    points = nodes.stored(points, "flag", "BOOLEAN", nodes.index(1.0))
    points = nodes.stored(points, "vector", "FLOAT_VECTOR", nodes.index(0.1))
    points = nodes.stored(points, "pair", "FLOAT2", nodes.index(0.2))
    points = nodes.stored(points, "color", "FLOAT_COLOR", (0.1, 0.5, 0.3, 0.4))
    points = nodes.stored(points, "turn", "QUATERNION", (0.1, 0.5, 0.3))
    nodes.output(on_points(nodes, points, hidden(names)))
    row["second"], row["number"], row["turn"] = 0.7, 0.9, 0.6
    assert_as_in_cycles(device, 4, len(names))


@needs_geometries
def test_instances_are_found_by_their_ids(device, hidden, add):
    """Also where several have the same id."""
    row = add("row", ([], []))
    nodes = GeometryNodes(row)
    points = nodes.points(9, (1.0, 0.0, 0.0))
    points = nodes.stored(points, "number", "FLOAT", nodes.index(0.1, 0.1))
    ids = nodes.index(-13.0, 70.0)
    repeated = nodes.add("ShaderNodeMath", operation="MAXIMUM").node
    nodes.tree.links.new(ids, repeated.inputs[0])
    repeated.inputs[1].default_value = 10.0
    points = nodes.add("GeometryNodeSetID", {"Geometry": points, "ID": repeated.outputs[0]})
    nodes.output(on_points(nodes, points, hidden(["number", "missing"])))
    assert_as_in_cycles(device, 9, 2)


@needs_geometries
@pytest.mark.parametrize("with_mesh", [False, True])
@pytest.mark.parametrize("is_curve", [False, True])
def test_nested_instances(device, hidden, add, with_mesh, is_curve):
    """Attributes of the inner level come first. Both levels may have a mesh besides instances."""
    names = ["inner", "outer", "both", "missing"]
    row = add("row", bpy.data.curves.new("row", "CURVE") if is_curve else ([], []))
    nodes = GeometryNodes(row)
    inner = nodes.points(2, (1.0, 0.0, 0.0))
    inner = nodes.stored(inner, "inner", "FLOAT", nodes.index(0.1, 0.3))
    inner = nodes.stored(inner, "both", "FLOAT", nodes.index(0.2, 0.5))
    things = hidden(names)
    instances = on_points(nodes, inner, things)
    square = nodes.add("GeometryNodeMeshGrid", {"Size X": 0.98, "Size Y": 0.98, "Vertices X": 2, "Vertices Y": 2})
    for k, thing in enumerate(things if with_mesh else ()):
        inputs = {"Geometry": square, "Offset": (0.5, 4.5 + k, 0.0)}
        moved = nodes.add("GeometryNodeSetPosition", inputs)
        material = thing.data.materials[0]
        moved = nodes.add("GeometryNodeSetMaterial", {"Geometry": moved, "Material": material})
        nodes.tree.links.new(moved, instances.node.inputs[0])
    outer = nodes.points(3, (2.0, 0.0, 0.0))
    outer = nodes.stored(outer, "outer", "FLOAT", nodes.index(0.1, 0.1))
    outer = nodes.stored(outer, "both", "FLOAT", nodes.index(0.1, 0.2))
    placed = nodes.add("GeometryNodeInstanceOnPoints", {"Points": outer, "Instance": instances})
    nodes.output(placed)
    assert_as_in_cycles(device, 6, 8)


@needs_geometries
def test_instances_in_instanced_collections(device, hidden, add):
    """Geometry nodes of an object that is instanced itself, by a collection instance."""
    inner = bpy.data.collections.new("inner")
    add("other", None, inner)
    row = add("row", ([], []), inner)
    nodes = GeometryNodes(row)
    points = nodes.stored(nodes.points(4, (1.0, 0.0, 0.0)), "number", "FLOAT", nodes.index(0.1, 0.2))
    nodes.output(on_points(nodes, points, hidden(["number", "of empty", "of row", "missing"])))
    row["of row"] = 0.4
    empty = add("empty", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", inner
    empty["of empty"] = 0.5
    assert_as_in_cycles(device, 4, 4)


@needs_geometries
def test_instances_of_objects_with_instances(device, hidden, add):
    """Geometry nodes instance an object that has geometry nodes."""
    row = add("row", ([], []))
    nodes = GeometryNodes(row)
    points = nodes.stored(nodes.points(2, (1.0, 0.0, 0.0)), "number", "FLOAT", nodes.index(0.1, 0.2))
    nodes.output(on_points(nodes, points, hidden(["number", "outer", "missing"])))
    row.location.z = -20.0
    rows = add("rows", ([], []))
    nodes = GeometryNodes(rows)
    points = nodes.stored(nodes.points(2, (2.0, 0.0, 0.0)), "outer", "FLOAT", nodes.index(0.1, 0.4))
    nodes.output(on_points(nodes, points, [row]))
    assert_as_in_cycles(device, 4, 3)


@pytest.mark.skipif(IS_KNOWN, reason="Blender 4.5 and later tell of instances")
def test_instances_are_not_known_before_blender_4_5(device, hidden, add):
    row = add("row", ([], []))
    nodes = GeometryNodes(row)
    points = nodes.stored(nodes.points(2, (1.0, 0.0, 0.0)), "number", "FLOAT", 0.3)
    nodes.output(on_points(nodes, points, hidden(["number", "of row"])))
    row["of row"] = 0.4
    see(2, 2)
    picture, warnings = ours(device, 2)
    assert np.allclose(centres(picture)[:, :, 0], [[0.0, 0.0], [0.4, 0.4]], atol=0.002)
    issue = "Attributes of instances that geometry nodes make are not known before Blender 4.5"
    assert warnings == (f"{issue}: 'row' (2).",)
