# SPDX-License-Identifier: GPL-3.0-or-later
"""The rotation of a world by a node Mapping. The map and its tables are made without it: turning a world makes none."""

import numpy as np

from ...shading.node_graph import NodeGraph
from ...shading.vectors import euler_matrix

#: Operations of the node that rotate a direction, and whether by the inverse of the node's rotation.
OPERATIONS = {"mapping_point": False, "mapping_vector": False, "mapping_normal": False, "mapping_texture": True}


def without_rotation(graph: NodeGraph, constants: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The rotation (3,3) of all directions that a graph reads, and its constants (R,4) without it.

    The graph then gives the radiance in a direction that was multiplied by the rotation. If the graph does anything
    else with directions, the rotation is the identity.
    """
    unchanged = np.eye(3), constants
    reading = [index for index, each in enumerate(graph.instructions) if each.operation == "world_direction"]
    users = [each for each in graph.instructions if not set(reading).isdisjoint(each.operands)]
    if len(users) != 1 or users[0].operation not in OPERATIONS or max(users[0].operands[1:]) >= 0:
        return unchanged
    location, angles, scale = (vector(graph, constants, operand) for operand in users[0].operands[1:])
    uses = [operand for each in graph.instructions for operand in each.operands].count(users[0].operands[2])
    if location.any() or (scale != 1.0).any() or uses != 1:
        return unchanged
    rotation = euler_matrix(angles.astype(np.float64))
    rest = constants.copy()
    rest[graph.locations[-1 - users[0].operands[2]].row, :3] = 0.0
    return rotation.T if OPERATIONS[users[0].operation] else rotation, rest


def vector(graph: NodeGraph, constants: np.ndarray, operand: int) -> np.ndarray:
    """(3,): the constant that an operand refers to."""
    numbers: np.ndarray = constants[graph.locations[-1 - operand].row, :3]
    return numbers
