# SPDX-License-Identifier: GPL-3.0-or-later
"""What passes through a surface: the colors of its transparent closures, as a graph."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import bpy
import numpy as np

from ....scene import NodeGraph
from ....shading.builder import Builder, Value, constant
from ....shading.operations import Constant
from ..diagnostics import Diagnostics
from ..node_graphs.reader import Closure

ONE, BLACK = constant(1.0), constant((0.0, 0.0, 0.0))

#: Limit of the cost of a graph that rays read. All shaders that trace such rays contain the graphs of a scene.
MAX_POINT_COST = 300

#: What is said where a node is not evaluated.
OPEN = "Ambient Occlusion nodes do not darken what materials emit and what passes through them"


#: Difference between a color's components up to which it counts as grey.
MAX_CHROMA = 0.002


#: Limit of the probability that camera rays pass surfaces on which shaders are added to a transparent one: without it,
#: the others would never be drawn. What is seen behind is divided by the probability.
ADDED_PASS_LIMIT = constant(0.75)


class Transparency(NamedTuple):
    """The graph of a surface's transparency, and its constants (R,4)."""

    graph: NodeGraph
    constants: np.ndarray


def passing(builder: Builder, closures: Sequence[Closure]) -> Value:
    """The color of what passes: of transparent closures, and where Principled has an alpha below 1."""
    total = BLACK
    for closure in closures:
        weight = closure.weight
        if closure.name == "transparent":
            color = closure.inputs["color"]
        elif closure.name == "principled":
            weight, color = builder.call("math_multiply", weight, uncovered(builder, closure)), constant(np.ones(3))
        else:
            continue
        total = builder.call("vector_add", total, builder.call("vector_scale", color, weight))
    return total


def is_colored(builder: Builder, color: Value) -> bool:
    """Whether a color is not grey everywhere, as far as its nodes tell. If constants may change, any color may."""
    color = builder.known(color)
    if color.is_constant and builder.simplifies:
        return float(np.ptp(color.constant)) > MAX_CHROMA
    return color.is_constant or builder.operation_of(color)[0] != "grey"


def covered(builder: Builder, closure: Closure) -> Value:
    """The fraction of a closure that is not transparent."""
    return builder.call("saturate", closure.inputs["alpha"]) if closure.name == "principled" else ONE


def uncovered(builder: Builder, closure: Closure) -> Value:
    """1 less that fraction."""
    return builder.call("math_subtract", ONE, covered(builder, closure))


def transparency(
    builder: Builder,
    closures: Sequence[Closure],
    mean: Callable[[Value], Constant],
    limit: Value | None,
    material: bpy.types.Material,
    findings: Diagnostics,
) -> Transparency | None:
    """What passes through a surface of these closures; None if nothing does. `mean`: about that of a value.

    `limit`: of the probability that camera rays pass, if there is one.
    """
    color = passing(builder, closures)
    if color.equals(0.0):
        return None
    colored = (each.name == "transparent" and is_colored(builder, each.inputs["color"]) for each in closures)
    tints = limit is not None or any(colored)
    limits = [] if limit is None else [builder.call("closure_pass_limit", limit)]
    for note in builder.notes([color]):
        findings.warn(note, material.name)
    graph, constants = builder.finish([builder.call("closure_transparent", color, parameter=int(tints)), *limits])
    if graph.uses("ambient_occlusion"):
        findings.warn(OPEN, material.name)
    if graph.cost > MAX_POINT_COST:
        issue = "Materials with too many nodes for what passes through them are evenly transparent"
        findings.warn(issue, material.name)
        even = builder.call("closure_transparent", constant(mean(color)), parameter=int(tints))
        graph, constants = builder.finish([even, *limits])
    return Transparency(graph, constants)
