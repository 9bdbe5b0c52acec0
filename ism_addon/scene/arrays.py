# SPDX-License-Identifier: GPL-3.0-or-later
"""Declares arrays of the scene with their fields: shape, dtype, unit and limit.

Snapshots, limits and Blender's readers use the declarations. A layout is a dtype and lengths, such as "float32 V 3".
A letter is the same length throughout its record; "or" separates shapes of different dimensions.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Self

import numpy as np

from .limits import is_within
from .quoting import shortened

#: The unit of directions of length 1.
UNIT_VECTOR = "unit vector"


@dataclass(frozen=True)
class ArrayFacts:
    """Declaration of an array field."""

    layout: str  # a dtype, or some with | between them, and lengths
    unit: str = ""  # "": a count, or dimensionless
    most: float | None = None  # largest absolute value
    first: int = 0  # smallest index
    into: str | int = ""  # of an index: its target, a field of the record or of the scene; or a length

    @property
    def dtypes(self) -> list[np.dtype]:
        """That the elements may have; the first is the default."""
        return [np.dtype(name) for name in self.layout.partition(" ")[0].split("|")]

    @property
    def dtype(self) -> np.dtype:
        """Of the elements, by default."""
        return self.dtypes[0]

    @property
    def shapes(self) -> list[list[str]]:
        """Lengths of each allowed shape, letters and numbers."""
        return [shape.split() for shape in self.layout.partition(" ")[2].split(" or ")]

    def empty(self) -> np.ndarray:
        """An array of no rows, of the first shape."""
        return np.zeros([0 if size.isalpha() else int(size) for size in self.shapes[0]], self.dtype)

    def converted(self, values: Any) -> np.ndarray:
        """Values as an array of the field's dtype; empty ones get its shape."""
        made = np.asarray(values, self.dtype)
        return made if made.size else made.reshape(self.empty().shape) if made.ndim == 1 else made

    def fault(self, array: np.ndarray, lengths: dict[str, int]) -> str | None:
        """Why an array is invalid for this field, as the end of a sentence; `lengths` keeps the letters' lengths."""
        sizes = next((shape for shape in self.shapes if len(shape) == array.ndim), None)
        if (
            array.dtype not in self.dtypes
            or sizes is None
            or any(
                length != (lengths.setdefault(size, length) if size.isalpha() else int(size))
                for size, length in zip(sizes, array.shape, strict=True)
            )
        ):
            found = f"{array.dtype} {' '.join(map(str, array.shape))}"
            return f"is {shortened(found)} where {self.layout} belongs"
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            return "holds numbers that are not finite"
        if self.most is not None and not is_within(array, self.most).all():
            return f"holds numbers beyond {self.most:g}"
        if self.unit == UNIT_VECTOR and not np.allclose(np.einsum("...i,...i", array, array), 1.0, atol=0.01):
            return "holds vectors that are not of unit length"
        return None


def array(layout: str, unit: str = "", most: float | None = None) -> Any:
    """A dataclass field that carries its ArrayFacts."""
    return field(metadata={"array": ArrayFacts(layout, unit, most)})


def index(layout: str, into: str | int, first: int = 0) -> Any:
    """A dataclass field of indices from `first` on; -1 stands for none."""
    return field(metadata={"array": ArrayFacts(layout, first=first, into=into)})


def array_facts(record: type) -> dict[str, ArrayFacts]:
    """The declarations of a record's array fields, by name."""
    return {member.name: member.metadata["array"] for member in fields(record) if "array" in member.metadata}


@dataclass(frozen=True, eq=False)
class Arrays:
    """Base class of records: arrays become read-only on construction. Compared by identity; see equals."""

    def __post_init__(self) -> None:
        for name in array_facts(type(self)):
            getattr(self, name).flags.writeable = False

    @classmethod
    def of(cls, **values: Any) -> Self:
        """From arrays or lists of any numeric type, converted to the declared types."""
        facts = array_facts(cls)
        return cls(**{name: facts[name].converted(value) if name in facts else value for name, value in values.items()})

    @classmethod
    def of_rows(cls, rows: Iterable[Mapping[str, Any]]) -> Self:
        """From rows, mappings by the fields' names."""
        rows = list(rows)
        return cls.of(**{name: [row[name] for row in rows] for name in array_facts(cls)})

    def equals(self, other: Self) -> bool:
        """Whether all fields have the same values."""
        pairs = ((getattr(self, member.name), getattr(other, member.name)) for member in fields(self))
        return all(np.array_equal(a, b) for a, b in pairs)

    @property
    def row_count(self) -> int:
        """Rows of the record's first array."""
        return len(getattr(self, next(iter(array_facts(type(self))))))
