# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds graphs: operations of constants are folded, equal ones are shared, and what nothing uses is left out."""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from .node_graph import NUMBERS, Instruction, NodeGraph
from .operations import OPERATIONS, Constant, evaluate

#: Blend modes in which a factor of 0 leaves the first colour.
WITHOUT_EFFECT_AT_ZERO = {
    f"blend_{mode}"
    for mode in (
        *("mix", "darken", "multiply", "lighten", "screen", "add", "overlay", "soft_light", "linear_light"),
        *("difference", "subtract", "divide", "hue", "saturation", "color"),
    )
} | {"mix_float", "mix_vector"}

#: Of these, a factor of 1 leaves the second colour.
MIXES = {"blend_mix", "mix_float", "mix_vector"}


#: Larger constants are clipped to float32's range.
MAX_CONSTANT = 3e38


class Value(NamedTuple):
    """The result of an operation, or a constant."""

    type: str
    operation: int = -1  # its index in the builder; -1: a constant
    constant: Constant = 0.0

    @property
    def is_constant(self) -> bool:
        """Whether it is the same at all points."""
        return self.operation < 0

    def equals(self, number: float) -> bool:
        """Whether it is the constant number, or a vector of it."""
        return self.is_constant and bool(np.all(np.asarray(self.constant) == number))


def constant(value: float | Sequence[float] | Sequence[Sequence[float]] | np.ndarray) -> Value:
    """A number, or three, four or a table of them; 0 in place of what is not finite."""
    array = np.nan_to_num(np.asarray(value, np.float64), nan=0.0, posinf=0.0, neginf=0.0)
    if array.ndim == 0:
        return Value("float", constant=float(array))
    return Value({3: "vec3", 4: "vec4"}[len(array)] if array.ndim == 1 else "table", constant=array)


class Builder:
    """Collects operations. The operands of each are values of the same builder.

    With `simplify`, what constants of 0 and 1 make needless is left out. Without, the graph of the same nodes is the
    same whatever their constants.
    """

    def __init__(self, simplify: bool = True) -> None:
        self.simplifies = simplify
        self._operations: list[tuple[str, tuple[Value, ...], int]] = []
        self._indices: dict[tuple, int] = {}
        #: What is to be said where a value stands for one that is not known, by the substitute's index.
        self._notes: dict[int, str] = {}

    def call(self, name: str, *operands: Value, parameter: int = 0) -> Value:
        """The result of an operation."""
        operation = OPERATIONS[name]
        types = tuple(operand.type for operand in operands)
        assert types == operation.operands, f"{name} of {types}"
        if operation.reference is not None and all(operand.is_constant for operand in operands):
            return Value(operation.result, constant=evaluate(name, *(operand.constant for operand in operands)))
        if self.simplifies and (simpler := self._simplified(name, operands)) is not None:
            return simpler
        index = len(self._operations)
        if not any(operand.is_constant for operand in operands):  # others are alike only until one of them is changed
            key = name, parameter, tuple(operand.operation for operand in operands)
            index = self._indices.setdefault(key, index)
        if index == len(self._operations):
            self._operations.append((name, operands, parameter))
        return Value(operation.result, index)

    def substitute(self, value: Value, note: str) -> Value:
        """A value in place of one that is not known. `notes` has the note if the value is used."""
        index = len(self._operations)
        self._operations.append(("", (value,), 0))
        self._notes[index] = note
        return Value(value.type, index)

    def known(self, value: Value) -> Value:
        """The value itself, or the one that a substitute is."""
        while value.operation in self._notes:
            (value,) = self._operations[value.operation][1]
        return value

    def varies(self, value: Value) -> bool:
        """Whether a value depends on the point of the surface or on an image."""
        used = self.used_by([value]) - self._notes.keys()
        return any(OPERATIONS[self._operations[index][0]].reference is None for index in used)

    def operation_of(self, value: Value) -> tuple[str, tuple[Value, ...], int]:
        """The operation, operands and parameter of a result."""
        name, operands, parameter = self._operations[value.operation]
        return name, tuple(map(self.known, operands)), parameter

    def used_by(self, roots: Iterable[Value]) -> set[int]:
        """The operations that values depend on."""
        used = {root.operation for root in roots if not root.is_constant}
        for index in reversed(range(len(self._operations))):
            if index in used:
                used.update(operand.operation for operand in self._operations[index][1] if not operand.is_constant)
        return used

    def notes(self, roots: Iterable[Value]) -> list[str]:
        """What is to be said about values that these depend on."""
        return [self._notes[index] for index in sorted(self.used_by(roots) & self._notes.keys())]

    def estimate(self, value: Value, unknown: Callable[[str, tuple[Constant, ...]], Constant]) -> Constant:
        """The constant that a value would be if `unknown` gave the results of operations without a reference."""
        results: dict[int, Constant] = {}
        for index in sorted(self.used_by([value])):
            name, operands, _ = self._operations[index]
            constants = tuple(each.constant if each.is_constant else results[each.operation] for each in operands)
            if not name:
                (results[index],) = constants
            elif OPERATIONS[name].reference is None:
                result = unknown(name, constants)
                results[index] = float(np.ravel(result)[0]) if OPERATIONS[name].result == "float" else result
            else:
                results[index] = evaluate(name, *constants)
        return value.constant if value.is_constant else results[value.operation]

    @staticmethod
    def _simplified(name: str, operands: tuple[Value, ...]) -> Value | None:
        """An operand that is the result, or a constant; None if it has to be computed."""
        if name in WITHOUT_EFFECT_AT_ZERO and operands[0].equals(0.0):
            return operands[1]
        if name in MIXES and operands[0].equals(1.0):
            return operands[2]
        if name == "noise_distorted" and operands[1].equals(0.0):
            return operands[0]
        if name in ("math_multiply", "vector_multiply", "vector_scale"):
            for one, other in (operands, operands[::-1]):
                if one.equals(0.0):
                    return Value(operands[0].type, constant=one.constant * np.zeros(NUMBERS[operands[0].type])[()])
                if one.equals(1.0) and other.type == operands[0].type:
                    return other
        if name in ("math_add", "vector_add"):
            for one, other in (operands, operands[::-1]):
                if one.equals(0.0):
                    return other
        return None

    def finish(self, roots: Sequence[Value]) -> tuple[NodeGraph, np.ndarray]:
        """The graph of the operations that the roots need, and its constants (R,4) float32."""
        used = self.used_by(roots) - self._notes.keys()
        order = {index: position for position, index in enumerate(sorted(used))}
        constants: list[Value] = []
        instructions = []
        for index in order:
            name, operands, parameter = self._operations[index]
            references = []
            for operand in map(self.known, operands):
                if operand.is_constant:
                    constants.append(operand)
                references.append(-len(constants) if operand.is_constant else order[operand.operation])
            instructions.append(Instruction(name, tuple(references), parameter))
        graph = NodeGraph(tuple(instructions), tuple(each.type for each in constants))
        numbers = np.zeros((graph.rows, 4), np.float32)
        for location, each in zip(graph.locations, constants, strict=True):
            flat = np.clip(np.ravel(each.constant), -MAX_CONSTANT, MAX_CONSTANT)
            first = 4 * location.row + location.first
            numbers.reshape(-1)[first : first + len(flat)] = flat
        return graph, numbers
