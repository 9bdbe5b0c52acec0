# SPDX-License-Identifier: GPL-3.0-or-later
"""Translates node graphs to GLSL: a function with a line for each instruction.

A surface has one graph, in a shader of its own. Transparency and emission are evaluated where rays meet surfaces:
shaders of rays have a function for each graph, at single points.

Operations that need differences, such as the footprint of an image, have operands that are evaluated three times: at
the point of the surface, and a pixel further in x and in y. Bumps have points of their own, further by their filters'
widths.
"""

from collections.abc import Iterator, Sequence

from ...shading.node_graph import Instruction, NodeGraph
from ...shading.operations import OPERATIONS
from ..gl.shader_compiler import GENERATED, Include

FILE = "surfaces/node_graph.glsl"
#: Files of point_functions.
POINT_FILES = {"transparency": "surfaces/transparency.glsl", "emission": "surfaces/surface_emission.glsl"}
#: What passes a surface, and the limit of the probability that camera rays do.
PASSES = "vec4(clamp(closures.transparency, 0.0, 1.0), closures.pass_limit)"
#: The type of their results, and these: of emission, the radiance, and the probability that camera rays pass.
POINT_RESULTS = {
    "transparency": ("vec4", PASSES),
    "emission": ("vec4", f"vec4(closures.emission, pass_probability({PASSES}))"),
}
GENERATED |= dict.fromkeys((FILE, *POINT_FILES.values()), lambda _constants: "")  # of shaders without a graph

#: The point at which instructions are evaluated, and those for the differences between pixels: their names in GLSL.
CENTRE = "at"
FOOTPRINT = "at_x", "at_y"
#: The point without a footprint: images are not filtered there, nor at the points of bumps.
UNFILTERED = "at_unfiltered"

#: Components of constants that are part of a row, by type.
SWIZZLES = {"float": 1, "image": 1, "vec3": 3, "vec4": 4}


def glsl(graph: NodeGraph) -> Include:
    """The file that a shader of a graph includes."""
    needed = needed_points(graph)
    lines = [
        *includes(graph),
        "Closures evaluate_graph(ShadingPoint at, Differentials differentials, int first_constant) {",
        *beginning(graph),
        *shifted_points(graph),
    ]
    for index, instruction in enumerate(graph.instructions):
        lines += (line(graph, index, instruction, point) for point in sorted(needed[index]))
    return Include(FILE, "\n".join([*lines, "    return closures;", "}"]))


def point_functions(graphs: Sequence[NodeGraph], member: str, table: str, fields: tuple[str, str]) -> Include:
    """A file with functions that evaluate graphs where rays meet surfaces.

    `member`: a key of POINT_RESULTS, and the functions' name. `fields` of `table`, rows by material of the record with
    that name: the index among these graphs, or -1, and the first of its constants.
    """
    type_, result = POINT_RESULTS[member]
    lines = [
        '#include "nodes/closures.glsl"',
        *dict.fromkeys(each for graph in graphs for each in includes(graph)),
    ]
    for key, graph in enumerate(graphs):
        lines += [f"{type_} {member}{key}(ShadingPoint at, int first_constant) {{", *beginning(graph)]
        for index, instruction in enumerate(graph.instructions):
            lines.append(line(graph, index, instruction, CENTRE, at_points=False))
        lines += [f"    return {result};", "}"]
    graph_field, constant_field = fields
    row = f"fetch_{table}(scene_records, {member}_graphs + material)"
    lines += [
        f"uniform int {member}_graphs; // rows of {table}, by material",
        f"bool has_{member}(int material) {{ return {row}.{graph_field} >= 0; }}",
        f"{type_} {member}(int material, ShadingPoint at) {{",
        f"    {table} row = {row};",
        *(
            f"    if (row.{graph_field} == {key}) return {member}{key}(at, row.{constant_field});"
            for key in range(len(graphs))
        ),
        f"    return {type_}(0.0);",
        "}",
    ]
    return Include(POINT_FILES[member], "\n".join(lines))


def includes(graph: NodeGraph) -> list[str]:
    """The files of a graph's operations."""
    files = sorted({OPERATIONS[each.operation].file for each in graph.instructions} | {"closures", "point"})
    return [f'#include "nodes/{file}.glsl"' for file in files]


def beginning(graph: NodeGraph) -> list[str]:
    """The first lines of a function: closures, and the rows of constants."""
    types = zip(graph.locations, graph.constants, strict=True)
    rows = sorted({location.row for location, type_ in types if type_ != "table"})
    return [
        "    Closures closures = no_closures();",
        *(f"    vec4 row{row} = graph_constant(first_constant + {row});" for row in rows),
    ]


def difference_points(graph: NodeGraph, index: int) -> tuple[str, str]:
    """The points whose differences from the centre an instruction takes."""
    if OPERATIONS[graph.instructions[index].operation].filter_width is None:
        return FOOTPRINT
    return f"at_x{index}", f"at_y{index}"


def shifted_points(graph: NodeGraph) -> Iterator[str]:
    """The lines that make the points of differences."""
    for point, way in zip(FOOTPRINT, ("dx", "dy"), strict=True):
        yield f"    ShadingPoint {point} = shifted(at, differentials.{way}, 1.0);"
    yield f"    ShadingPoint {UNFILTERED} = at;"
    for index, instruction in enumerate(graph.instructions):
        width = OPERATIONS[instruction.operation].filter_width
        if width is not None:
            value = operand_name(graph, instruction.operands[width], CENTRE)
            for point, way in zip(difference_points(graph, index), ("tangent", "bitangent"), strict=True):
                yield f"    ShadingPoint {point} = shifted(at, differentials.{way}, {value});"


def has_footprint(points: set[str]) -> bool:
    """Whether images are filtered at any of these points."""
    return not points.isdisjoint({CENTRE, *FOOTPRINT})


def needed_points(graph: NodeGraph) -> list[set[str]]:
    """The points where each instruction has to be evaluated."""
    needed = [set() if OPERATIONS[each.operation].result else {CENTRE} for each in graph.instructions]
    for index in reversed(range(len(graph.instructions))):
        instruction = graph.instructions[index]
        for position, operand in enumerate(instruction.operands):
            if operand >= 0 and needed[index]:
                operation = OPERATIONS[instruction.operation]
                is_unfiltered = position in operation.unfiltered
                needed[operand] |= {UNFILTERED} if is_unfiltered else needed[index]
                if position in operation.with_differences and (is_unfiltered or has_footprint(needed[index])):
                    needed[operand] |= {UNFILTERED if is_unfiltered else CENTRE, *difference_points(graph, index)}
    return needed


def line(graph: NodeGraph, index: int, instruction: Instruction, point: str, at_points: bool = True) -> str:
    """The line that evaluates an instruction at a point; with differences of 0, unless there are several points."""
    operation = OPERATIONS[instruction.operation]
    arguments = [] if operation.result else ["closures"]
    if operation.at_point:
        arguments.append(point)
    for position, operand in enumerate(instruction.operands):
        is_unfiltered = at_points and position in operation.unfiltered
        arguments.append(operand_name(graph, operand, UNFILTERED if is_unfiltered else point))
        if position not in operation.with_differences:
            continue
        if is_unfiltered or (at_points and has_footprint({point})):
            here = operand_name(graph, operand, UNFILTERED if is_unfiltered else CENTRE)
            others = (operand_name(graph, operand, other) for other in difference_points(graph, index))
            arguments += [f"{other} - {here}" for other in others]
        else:
            arguments += [f"{operation.operands[position]}(0.0)"] * len(FOOTPRINT)
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
