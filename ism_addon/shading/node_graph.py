# SPDX-License-Identifier: GPL-3.0-or-later
"""Node graphs as data: instructions in the order of their evaluation.

Constants are no part of a graph: each material has its own. So materials that differ only in those share a shader.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from .closures import BUMPS, COAT, EXTRA, GLOSSY, WITHOUT_NORMAL
from .operations import OPERATIONS

#: Numbers of a constant of each type. Constants are stored in rows of four numbers.
NUMBERS = {"float": 1, "image": 1, "vec3": 3, "vec4": 4, "table": 4 * 256}

#: Operations that depend on the camera, or how their names begin.
VIEW_OPERATIONS = "coordinate_camera", "coordinate_window", "ray_length", "camera_from_world", "world_from_camera"
#: Likewise those that may differ between the sides of a surface.
SIDE_OPERATIONS = "geometry_backfacing", "geometry_normal", "geometry_true_normal", "geometry_incoming"


@dataclass(frozen=True)
class Instruction:
    """One operation. Its result is referred to by the instruction's index."""

    operation: str  # a key of OPERATIONS
    operands: tuple[int, ...]  # indices of earlier instructions, or -1 - k for constant k
    parameter: int = 0  # part of the shader, such as the index of a UV layer


class Location(NamedTuple):
    """Where a constant is among a material's constants."""

    row: int
    first: int  # of the row's four numbers


@dataclass(frozen=True)
class NodeGraph:
    """What the nodes of a material compute. The last instructions add to its closures."""

    instructions: tuple[Instruction, ...]
    constants: tuple[str, ...]  # types, keys of NUMBERS

    def __post_init__(self) -> None:
        """Raises ValueError if an operation or an operand does not exist or has another type."""
        for index, instruction in enumerate(self.instructions):
            if instruction.operation not in OPERATIONS:
                raise ValueError(f"operation {instruction.operation} is not known")
            types = OPERATIONS[instruction.operation].operands
            if types != tuple(self._type(operand, index) for operand in instruction.operands):
                raise ValueError(f"the operands of instruction {index} are not those of {instruction.operation}")
        if unknown := set(self.constants) - set(NUMBERS):
            raise ValueError(f"constants of type {unknown.pop()} are not known")

    def _type(self, operand: int, end: int) -> str:
        """Type of an operand of the instruction `end`; "" if there is none."""
        if operand < 0:
            return self.constants[-1 - operand] if -1 - operand < len(self.constants) else ""
        return OPERATIONS[self.instructions[operand].operation].result if operand < end else ""

    def uses(self, operation: str) -> bool:
        """Whether an instruction has an operation, or one whose name begins with it."""
        return any(each.operation.startswith(operation) for each in self.instructions)

    def images(self, constants: np.ndarray) -> list[int]:
        """The indices of the images that it reads, of its constants (R,4)."""
        places = zip(self.locations, self.constants, strict=True)
        return [int(constants[location]) for location, type_ in places if type_ == "image"]

    @cached_property
    def cost(self) -> int:
        """How long it takes to compile; that grows with the square of it."""
        return sum(OPERATIONS[each.operation].cost for each in self.instructions)

    @cached_property
    def changes_normals(self) -> bool:
        """Whether any closure has another normal than the mesh."""
        closures = (each for each in self.instructions if not OPERATIONS[each.operation].result)
        normals = (each.operands[-1] for each in closures if each.operation not in WITHOUT_NORMAL)
        return any(operand < 0 or self.instructions[operand].operation != "geometry_normal" for operand in normals)

    @cached_property
    def reflects(self) -> bool:
        """Whether it is of what a surface reflects, not of its transparency or emission."""
        return not any(each.operation in WITHOUT_NORMAL for each in self.instructions)

    @cached_property
    def tints(self) -> bool:
        """Whether light that passes may have another color afterwards."""
        return any(each.operation == "closure_transparent" and each.parameter for each in self.instructions)

    @cached_property
    def has_gloss(self) -> bool:
        """Whether it has other closures than Lambert's."""
        return self.has_coat or self.has_extra or any(each.operation in GLOSSY for each in self.instructions)

    @cached_property
    def has_coat(self) -> bool:
        """Whether it has a lobe above the others."""
        return any(each.operation in COAT for each in self.instructions)

    @cached_property
    def has_extra(self) -> bool:
        """Whether it has anisotropy, sheen or rough diffuse closures."""
        return any(each.operation in EXTRA for each in self.instructions)

    @cached_property
    def bump_shadowing(self) -> int:
        """By which function bumps take away light, see materials/bump_shadowing.glsl; 0: they do not."""
        return max((each.parameter for each in self.instructions if each.operation == BUMPS), default=0)

    @cached_property
    def emits(self) -> bool:
        """Whether it is of what a surface emits."""
        return self.uses("closure_emission")

    @cached_property
    def reads_view(self) -> bool:
        """Whether it reads where the camera is."""
        return any(map(self.uses, VIEW_OPERATIONS))

    @cached_property
    def reads_side(self) -> bool:
        """Whether it may differ between the sides of a surface."""
        return any(map(self.uses, SIDE_OPERATIONS))

    @property
    def traces_rays(self) -> bool:
        """Whether rays are traced where it is evaluated."""
        return self.reflects and self.uses("ambient_occlusion")

    @property
    def reads_objects(self) -> bool:
        """Whether it reads what is known of the object."""
        return any(OPERATIONS[each.operation].file == "object" for each in self.instructions)

    @cached_property
    def locations(self) -> tuple[Location, ...]:
        """The location of each constant. Single numbers fill the rows of vectors and of each other."""
        locations, rows, free = [], 0, list[Location]()
        for count in map(NUMBERS.__getitem__, self.constants):
            if count == 1 and free:
                location = free.pop()
            else:
                location, rows = Location(rows, 0), rows + -(-count // 4)
            if (end := location.first + count) < 4:
                free.append(Location(location.row, end))
            locations.append(location)
        return tuple(locations)

    @cached_property
    def rows(self) -> int:
        """Number of rows of all constants."""
        ends = (each.row + -(-NUMBERS[type_] // 4) for each, type_ in zip(self.locations, self.constants, strict=True))
        return max(ends, default=0)
