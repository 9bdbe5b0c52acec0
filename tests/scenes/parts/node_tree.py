# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes materials and worlds by functions that add nodes."""

import bpy


class Tree:
    """Adds nodes to a tree."""

    def __init__(self, tree):
        self.nodes, self.links = tree.nodes, tree.links

    def add(self, node_type, inputs=None, **options):
        """A node of a type, with options and inputs: values, nodes or outputs of nodes."""
        node = self.nodes.new(node_type)
        for name, value in options.items():
            setattr(node, name, value)
        for name, value in (inputs or {}).items():
            if isinstance(value, bpy.types.Node | bpy.types.NodeSocket):
                self.link(value, node.inputs[name])
            else:
                node.inputs[name].default_value = value
        return node

    def link(self, source, target):
        """Link an output, or the first one of a node."""
        self.links.new(source.outputs[0] if isinstance(source, bpy.types.Node) else source, target)


def made(make) -> bpy.types.Material:
    """A material whose surface is the node that `make` makes."""
    return _with_surface(bpy.data.materials.new("made"), make, "Material Output")


def world_of(make) -> bpy.types.World:
    """A world whose surface is the node that `make` makes."""
    return _with_surface(bpy.data.worlds.new("made"), make, "World Output")


def _with_surface(owner, make, output):
    if bpy.app.version < (5, 0):
        owner.use_nodes = True
    tree = Tree(owner.node_tree)
    tree.link(make(tree), owner.node_tree.nodes[output].inputs["Surface"])
    return owner
