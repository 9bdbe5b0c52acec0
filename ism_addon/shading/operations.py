# SPDX-License-Identifier: GPL-3.0-or-later
"""The operations of node graphs: types of their operands and results, and references.

An operation is a GLSL function of the same name, in a file of gpu/glsl/nodes. Operations of constants have a reference
in Python: it folds constants, and tests compare the shaders with it.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

#: Shapes of results.
SHAPES: dict[str, tuple[int, ...]] = {"float": (), "vec3": (3,), "vec4": (4,)}

#: A constant of a graph: a number, or an array (3,), (4,) or (256,4) float64.
Constant = float | np.ndarray


class Operation(NamedTuple):
    """What an operation takes and gives."""

    operands: tuple[str, ...]  # GLSL types, or "image" or "table"
    result: str  # GLSL type; "": it adds to the closures
    file: str  # of its GLSL function, without extension
    reference: Callable[..., Any] | None = None  # of arrays and numbers; None: it is not evaluated on the CPU
    #: Whether it depends on the point of the surface, which is then the function's first argument.
    at_point: bool = False
    #: Whether an instruction's parameter is the function's last argument.
    has_parameter: bool = False
    #: Operands that the function gets with their differences from pixel to pixel, in x and in y.
    with_differences: tuple[int, ...] = ()
    #: The operand that says how many pixels away these differences are taken, as Cycles takes them for bumps. It is a
    #: constant. None: a pixel's footprint.
    filter_width: int | None = None
    #: Operands in which images are not filtered, as in Cycles: a filtered height or normal would be smoother.
    unfiltered: tuple[int, ...] = ()
    #: How long it takes to compile, relative to an addition of vectors.
    cost: int = 1
    #: About the mean of the result, where it is not evaluated.
    mean: float = 0.0


OPERATIONS: dict[str, Operation] = {}


def register(file: str, operands: str, result: str, /, **references: Callable[..., Any]) -> None:
    """Register operations by name, with their references. `operands`: types separated by spaces."""
    types = tuple(operands.split())
    OPERATIONS.update({name: Operation(types, result, file, function) for name, function in references.items()})


def set_cost(cost: int, *names: str) -> None:
    """Set the cost of operations."""
    OPERATIONS.update({name: OPERATIONS[name]._replace(cost=cost) for name in names})


def evaluate(name: str, *operands: Constant) -> Constant:
    """The result of an operation of constants; 0 in place of what is not finite. Raises KeyError."""
    reference = OPERATIONS[name].reference
    if reference is None:
        raise KeyError(f"{name} has no reference")
    with np.errstate(all="ignore"):
        try:
            result = np.asarray(reference(*operands), np.float64)
        except (ArithmeticError, ValueError):  # what numpy calls infinite or no number
            result = np.zeros(SHAPES[OPERATIONS[name].result])
        result = np.nan_to_num(result, nan=0.0, posinf=0.0, neginf=0.0)
    return float(result) if result.ndim == 0 else result
