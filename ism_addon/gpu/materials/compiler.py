# SPDX-License-Identifier: GPL-3.0-or-later
"""Translates node graphs to GLSL: a function with a line for each instruction.

Operations that need differences, such as the footprint of an image, have operands that are evaluated three times: at
the point of the surface, and a pixel further in x and in y.
"""

from ...shading.node_graph import Instruction, NodeGraph
from ...shading.operations import OPERATIONS
from ..gl.shader_compiler import GENERATED, Include

FILE = "surfaces/node_graph.glsl"
GENERATED[FILE] = lambda _constants: ""  # of shaders without a graph

#: The points at which an instruction may be evaluated, by their names in GLSL.
POINTS = CENTRE, _, _ = "at", "at_x", "at_y"

#: Components of constants that are part of a row, by type.
SWIZZLES = {"float": 1, "image": 1, "vec3": 3, "vec4": 4}


def glsl(graph: NodeGraph) -> Include:
    """The file that a shader of a graph includes."""
    needed = needed_points(graph)
    files = sorted({OPERATIONS[each.operation].file for each in graph.instructions} | {"closures", "point"})
    types = zip(graph.locations, graph.constants, strict=True)
    rows = sorted({location.row for location, type_ in types if type_ != "table"})
    lines = [
        *(f'#include "nodes/{file}.glsl"' for file in files),
        "Closures evaluate_graph(ShadingPoint at, ShadingPoint at_x, ShadingPoint at_y, int first_constant) {",
        "    Closures closures = Closures(vec3(0.0), vec3(0.0));",
        *(f"    vec4 row{row} = texelFetch(graph_constants, first_constant + {row});" for row in rows),
    ]
    for index, instruction in enumerate(graph.instructions):
        lines += (line(graph, index, instruction, point) for point in POINTS if (index, point) in needed)
    return Include(FILE, "\n".join([*lines, "    return closures;", "}"]))


def needed_points(graph: NodeGraph) -> set[tuple[int, str]]:
    """The instructions that have to be evaluated, with the points where."""
    needed = {(index, CENTRE) for index, each in enumerate(graph.instructions) if not OPERATIONS[each.operation].result}
    for index in reversed(range(len(graph.instructions))):
        points = [point for point in POINTS if (index, point) in needed]
        instruction = graph.instructions[index]
        for position, operand in enumerate(instruction.operands):
            if operand >= 0 and points:
                differs = position in OPERATIONS[instruction.operation].with_differences
                needed.update((operand, point) for point in (POINTS if differs else points))
    return needed


def line(graph: NodeGraph, index: int, instruction: Instruction, point: str) -> str:
    """The line that evaluates an instruction at a point."""
    operation = OPERATIONS[instruction.operation]
    arguments = [] if operation.result else ["closures"]
    if operation.at_point:
        arguments.append(point)
    for position, operand in enumerate(instruction.operands):
        arguments.append(operand_name(graph, operand, point))
        if position in operation.with_differences:
            here, *others = (operand_name(graph, operand, each) for each in POINTS)
            arguments += [f"{other} - {here}" for other in others]
    if operation.has_parameter:
        arguments.append(str(instruction.parameter))
    call = f"{instruction.operation}({', '.join(arguments)});"
    return f"    {operation.result} {result_name(index, point)} = {call}" if operation.result else f"    {call}"


def result_name(index: int, point: str) -> str:
    """Name of an instruction's result at a point."""
    return f"v{index}" if point == CENTRE else f"v{index}_{point}"


def operand_name(graph: NodeGraph, operand: int, point: str) -> str:
    """Name of an operand at a point; of a table, the row where it begins."""
    if operand >= 0:
        return result_name(operand, point)
    location, type_ = graph.locations[-1 - operand], graph.constants[-1 - operand]
    if type_ == "table":
        return f"first_constant + {location.row}"
    return f"row{location.row}.{'xyzw'[location.first : location.first + SWIZZLES[type_]]}"
