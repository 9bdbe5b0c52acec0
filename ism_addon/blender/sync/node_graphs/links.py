# SPDX-License-Identifier: GPL-3.0-or-later
"""Follows links of shader nodes through reroutes, muted nodes and node groups."""

from collections.abc import Iterator
from typing import NamedTuple

import bpy

#: Limit of the links that are followed from one socket: more are a circle.
MAX_LINKS = 10_000

#: The group nodes that a node is inside of, outermost first.
Path = tuple[bpy.types.Node, ...]


class Source(NamedTuple):
    """Where the value of an input comes from."""

    path: Path
    socket: bpy.types.NodeSocket  # an output, or the input whose own value counts
    types: tuple[str, ...]  # of the sockets on the way, from this one to the input
    is_linked: bool


class NodeKey(NamedTuple):
    """Identifies a node in a group."""

    path: tuple[int, ...]
    node: int

    @classmethod
    def of(cls, path: Path, node: bpy.types.Node) -> "NodeKey":
        """The key of a node inside of these group nodes."""
        return cls(tuple(each.as_pointer() for each in path), node.as_pointer())


class Links:
    """The links of node trees, by the input that they lead to: Blender's sockets search all links of their tree."""

    def __init__(self) -> None:
        self._of_trees: dict[int, dict[int, bpy.types.NodeLink]] = {}

    def _link_to(self, socket: bpy.types.NodeSocket) -> bpy.types.NodeLink | None:
        """The link to an input, if there is one."""
        tree = socket.id_data
        key = tree.as_pointer()
        if key not in self._of_trees:
            self._of_trees[key] = {link.to_socket.as_pointer(): link for link in tree.links}
        return self._of_trees[key].get(socket.as_pointer())

    def source(self, path: Path, socket: bpy.types.NodeSocket) -> Source:
        """Where an input's value comes from. Cycles converts it to the type of each socket on the way."""
        own, own_path, types = socket, path, [socket.type]
        for _ in range(MAX_LINKS):
            link = self._link_to(socket)
            if link is None or link.is_muted or not link.is_valid:
                break
            from_socket, node = link.from_socket, link.from_node
            if node.bl_idname == "NodeReroute":
                socket = node.inputs[0]
            elif node.mute:
                inner = (each.from_socket for each in node.internal_links if each.to_socket == from_socket)
                if (passed := next(inner, None)) is None:
                    break
                socket = passed
            elif node.type == "GROUP":
                output = active_output(node.node_tree) if node.node_tree is not None else None
                inside = socket_of(output.inputs, from_socket.identifier) if output is not None else None
                if inside is None:
                    break
                path, socket = (*path, node), inside
                own, own_path = socket, path
            elif node.bl_idname == "NodeGroupInput":
                outside = socket_of(path[-1].inputs, from_socket.identifier) if path else None
                if outside is None:
                    break
                path, socket = path[:-1], outside
                own, own_path = socket, path
            else:
                return Source(path, from_socket, (from_socket.type, *reversed(types)), True)
            types.append(socket.type)
        return Source(own_path, own, tuple(reversed(types)), False)

    def upstream(self, path: Path, socket: bpy.types.NodeSocket) -> Iterator[tuple[Path, bpy.types.Node]]:
        """All nodes that a socket depends on, each after those that it depends on. Circles are cut."""
        entered, stack = set[NodeKey](), list[tuple[Path, bpy.types.Node, Iterator[Source]]]()

        def enter(found: Source) -> None:
            key = NodeKey.of(found.path, found.socket.node)
            if found.is_linked and key not in entered:
                entered.add(key)
                node = found.socket.node
                sources = (
                    self.source(found.path, each) for each in node.inputs if each.enabled and not each.is_unavailable
                )
                stack.append((found.path, node, sources))

        enter(self.source(path, socket))
        while stack:
            node_path, node, sources = stack[-1]
            following = next(sources, None)
            if following is None:
                stack.pop()
                yield node_path, node
            else:
                enter(following)


def active_output(tree: bpy.types.NodeTree) -> bpy.types.Node | None:
    """The output node of a group."""
    outputs = [node for node in tree.nodes if node.bl_idname == "NodeGroupOutput"]
    return next((node for node in outputs if node.is_active_output), outputs[0] if outputs else None)


def socket_of(sockets: bpy.types.NodeInputs, identifier: str) -> bpy.types.NodeSocket | None:
    """The socket with an identifier."""
    return next((socket for socket in sockets if socket.identifier == identifier), None)
