# SPDX-License-Identifier: GPL-3.0-or-later
"""What an array of the scene is, said once, where the field is declared: shape, dtype, unit and limit.

The snapshot's checks, the limits and Blender's readers all read it there. A layout is a dtype and lengths, such as
"float32 V 3"; a letter is one length throughout its record; "or" parts shapes of different numbers of axes.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Self

import numpy as np

from ..quoting import shortened
from .limits import is_within

#: The unit of directions, whose length is 1.
UNIT_VECTOR = "unit vector"


@dataclass(frozen=True)
class ArrayFacts:
    """What is known of the arrays of a field."""

    layout: str
    unit: str = ""  # "": a number of things, or no quantity at all
    most: float | None = None  # no number is beyond it, on either side of 0
    first: int = 0  # of an index: the least
    into: str | int = ""  # of an index: the field of the record, or of the scene, that it leads into; or the length

    @property
    def dtype(self) -> np.dtype:
        """Of the elements."""
        return np.dtype(self.layout.partition(" ")[0])

    @property
    def shapes(self) -> list[list[str]]:
        """Lengths of each shape that is allowed, letters and numbers."""
        return [shape.split() for shape in self.layout.partition(" ")[2].split(" or ")]

    def empty(self) -> np.ndarray:
        """An array of no rows, of the first shape."""
        return np.zeros([0 if size.isalpha() else int(size) for size in self.shapes[0]], self.dtype)

    def converted(self, values: Any) -> np.ndarray:
        """Values as an array of the field: of its dtype, and where they are none, of its shape."""
        made = np.asarray(values, self.dtype)
        return made if made.size else made.reshape(self.empty().shape) if made.ndim == 1 else made

    def fault(self, array: np.ndarray, lengths: dict[str, int]) -> str | None:
        """What keeps an array from being of this field, as the rest of a sentence; `lengths` keeps the letters'."""
        sizes = next((shape for shape in self.shapes if len(shape) == array.ndim), None)
        if (
            array.dtype != self.dtype
            or sizes is None
            or any(
                length != (lengths.setdefault(size, length) if size.isalpha() else int(size))
                for size, length in zip(sizes, array.shape, strict=True)
            )
        ):
            seen = f"{array.dtype} {' '.join(map(str, array.shape))}"
            return f"is {shortened(seen)} where {self.layout} belongs"
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
    """The same of a field of indices, from `first` on: -1 where some lead nowhere."""
    return field(metadata={"array": ArrayFacts(layout, first=first, into=into)})


def array_facts(record: type) -> dict[str, ArrayFacts]:
    """Those of a record's array fields, by name."""
    return {member.name: member.metadata["array"] for member in fields(record) if "array" in member.metadata}


@dataclass(frozen=True, eq=False)
class Arrays:
    """Base of the records: locks every array on construction. Compared by identity, but see equals."""

    def __post_init__(self) -> None:
        for name in array_facts(type(self)):
            getattr(self, name).flags.writeable = False

    @classmethod
    def of(cls, **values: Any) -> Self:
        """From values of any numeric type, which may be lists: each becomes an array as its field says."""
        facts = array_facts(cls)
        return cls(**{name: facts[name].converted(value) if name in facts else value for name, value in values.items()})

    @classmethod
    def of_rows(cls, rows: Iterable[Mapping[str, Any]]) -> Self:
        """The same from one row after another, each by the fields' names."""
        rows = list(rows)
        return cls.of(**{name: [row[name] for row in rows] for name in array_facts(cls)})

    def equals(self, other: Self) -> bool:
        """Whether all members have the same values."""
        pairs = ((getattr(self, member.name), getattr(other, member.name)) for member in fields(self))
        return all(np.array_equal(a, b) for a, b in pairs)

    @property
    def row_count(self) -> int:
        """Rows of the record's first array."""
        return len(getattr(self, next(iter(array_facts(type(self))))))
