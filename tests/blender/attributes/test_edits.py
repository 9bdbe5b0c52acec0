# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of instances are read again when they have changed."""

import bpy
import numpy as np


def test_edits_are_read(latest_scene, squares, add):
    """Of properties of all that attributes are looked up of."""
    inner, scene = bpy.data.collections.new("inner"), bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    (placed,), (source,), _ = (squares(type_, ["number"], ["Color"]) for type_ in ("OBJECT", "INSTANCER", "VIEW_LAYER"))
    scene.collection.objects.unlink(source)
    inner.objects.link(source)
    empty = add("empty", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", inner
    latest_scene()
    owners = placed.data, placed, source.data, source, empty, scene.world, scene
    for k, owner in enumerate(owners):
        owner["number"] = 0.5 + k
        owner.update_tag()
        attributes = latest_scene().instances.attributes
        assert (attributes == 0.5 + k).any(), owner


def test_edits_of_instanced_objects_are_read(latest_scene, squares, add):
    """Also of properties that Blender reports of the object alone."""
    inner = bpy.data.collections.new("inner")
    (source,) = squares("OBJECT", ["color"], ["Color"])
    bpy.context.scene.collection.objects.unlink(source)
    inner.objects.link(source)
    empty = add("empty", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", inner
    latest_scene()
    source.color = 0.1, 0.2, 0.3, 0.4
    assert np.allclose(latest_scene().instances.attributes, [0.1, 0.2, 0.3, 0.4])
