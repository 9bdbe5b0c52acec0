# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes modifiers of geometry nodes that instance objects."""

import bpy


class GeometryNodes:
    """Adds nodes to a modifier of an object."""

    def __init__(self, thing):
        self.tree = bpy.data.node_groups.new("nodes", "GeometryNodeTree")
        self.tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
        thing.modifiers.new("nodes", "NODES").node_group = self.tree

    def add(self, node_type, inputs=None, **options):
        """A node of a type, with options and inputs by index or name: values, or outputs of nodes."""
        node = self.tree.nodes.new(node_type)
        for name, value in options.items():
            setattr(node, name, value)
        for name, value in (inputs or {}).items():
            self.set_input(node, name, value)
        return node.outputs[0] if node.outputs else node

    def set_input(self, node, name, value):
        """Set or link an input that is available."""
        socket = next(each for each in node.inputs if each.name == name and each.enabled)
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        else:
            socket.default_value = value

    def points(self, count, offset):
        """Points along a line."""
        inputs = {"Count": count, "Offset": offset}
        return self.add("GeometryNodeMeshLine", inputs)

    def stored(self, geometry, name, data_type, value, domain="POINT"):
        """The geometry with an attribute."""
        inputs = {"Geometry": geometry, "Name": name, "Value": value}
        return self.add("GeometryNodeStoreNamedAttribute", inputs, data_type=data_type, domain=domain)

    def index(self, factor, first=0.0):
        """A number for each element."""
        inputs = self.add("GeometryNodeInputIndex")
        node = self.add("ShaderNodeMath", operation="MULTIPLY_ADD").node
        self.tree.links.new(inputs, node.inputs[0])
        node.inputs[1].default_value, node.inputs[2].default_value = factor, first
        return node.outputs[0]

    def output(self, geometry):
        """What the modifier makes."""
        self.add("NodeGroupOutput", {"Geometry": geometry})


def on_points(nodes, points, things):
    """Instances of objects on points, above one another in y."""
    joined = nodes.add("GeometryNodeJoinGeometry")
    for y, thing in enumerate(things):
        info = nodes.add("GeometryNodeObjectInfo", {"Object": thing, "As Instance": True})
        moved = nodes.add("GeometryNodeSetPosition", {"Geometry": points, "Offset": (0.0, y, 0.0)})
        instances = nodes.add(
            "GeometryNodeInstanceOnPoints", {"Points": moved, "Instance": info.node.outputs["Geometry"]}
        )
        nodes.tree.links.new(instances, joined.node.inputs[0])
    return joined
