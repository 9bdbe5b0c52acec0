# SPDX-License-Identifier: GPL-3.0-or-later
"""Declares arrays of the scene with their fields: shape, dtype, unit and limit.

Snapshots, limits and Blender's readers use the declarations. A layout is a dtype and a shape, such as "float32 V 3".
A letter stands for the same length in all arrays of a record; "or" separates shapes of different dimensions.
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
class ArraySpec:
    """Declaration of an array field."""

    layout: str  # a dtype, or several separated by |, and a shape
    unit: str = ""  # "": a count, or dimensionless
    max_abs: float | None = None  # largest absolute value
    is_signed: bool = True  # whether values may be negative
    first: int = 0  # smallest index
    into: str | int = ""  # what indices refer to: a field of the record or of the scene; or its length

    @property
    def dtypes(self) -> list[np.dtype]:
        """Allowed dtypes; the first is the default."""
        return [np.dtype(name) for name in self.layout.partition(" ")[0].split("|")]

    @property
    def dtype(self) -> np.dtype:
        """The default dtype."""
        return self.dtypes[0]

    @property
    def shapes(self) -> list[list[str]]:
        """Allowed shapes, as lists of letters and numbers."""
        return [shape.split() for shape in self.layout.partition(" ")[2].split(" or ")]

    def empty(self) -> np.ndarray:
        """An array without rows, of the first shape."""
        return np.zeros([0 if size.isalpha() else int(size) for size in self.shapes[0]], self.dtype)

    def converted(self, values: Any) -> np.ndarray:
        """Values as an array of the default dtype; an empty array gets the first shape."""
        array = np.asarray(values, self.dtype)
        return array if array.size else array.reshape(self.empty().shape) if array.ndim == 1 else array

    def fault(self, array: np.ndarray, lengths: dict[str, int]) -> str | None:
        """Why an array is invalid for this field, as the end of a sentence; `lengths` collects the letters' lengths."""
        sizes = next((shape for shape in self.shapes if len(shape) == array.ndim), None)
        if (
            array.dtype not in self.dtypes
            or sizes is None
            or any(
                length != (lengths.setdefault(size, length) if size.isalpha() else int(size))
                for size, length in zip(sizes, array.shape, strict=True)
            )
        ):
            actual = f"{array.dtype} {' '.join(map(str, array.shape))}"
            return f"is {shortened(actual)} where {self.layout} belongs"
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            return "holds numbers that are not finite"
        if self.max_abs is not None and not is_within(array, self.max_abs).all():
            return f"holds numbers beyond {self.max_abs:g}"
        if not self.is_signed and (array < 0.0).any():
            return "holds negative numbers"
        if self.unit == UNIT_VECTOR and not np.allclose(np.einsum("...i,...i", array, array), 1.0, atol=0.01):
            return "holds vectors that are not of unit length"
        return None


def array(layout: str, unit: str = "", max_abs: float | None = None, is_signed: bool = True) -> Any:
    """A dataclass field with its ArraySpec as metadata."""
    return field(metadata={"array": ArraySpec(layout, unit, max_abs, is_signed)})


def optional_array(layout: str, first: int = 0, into: str | int = "") -> Any:
    """The same, without rows by default. `first` and `into`: of indices."""
    spec = ArraySpec(layout, first=first, into=into)
    return field(default_factory=spec.empty, metadata={"array": spec})


def index(layout: str, into: str | int, first: int = 0) -> Any:
    """A dataclass field of indices, of which `first` is the smallest; -1 means none."""
    return field(metadata={"array": ArraySpec(layout, first=first, into=into)})


def array_specs(record: type) -> dict[str, ArraySpec]:
    """The declarations of a record's array fields, by name."""
    return {member.name: member.metadata["array"] for member in fields(record) if "array" in member.metadata}


@dataclass(frozen=True, eq=False)
class Arrays:
    """Base class of records. Their arrays become read-only on construction. == compares identity; see equals."""

    def __post_init__(self) -> None:
        for name in array_specs(type(self)):
            getattr(self, name).flags.writeable = False

    @classmethod
    def of(cls, **values: Any) -> Self:
        """A record from arrays or lists, converted to the declared dtypes."""
        specs = array_specs(cls)
        return cls(**{name: specs[name].converted(value) if name in specs else value for name, value in values.items()})

    @classmethod
    def of_rows(cls, rows: Iterable[Mapping[str, Any]]) -> Self:
        """A record from rows: mappings with a value for each field."""
        rows = list(rows)
        return cls.of(**{name: [row[name] for row in rows] for name in array_specs(cls)})

    def equals(self, other: Self) -> bool:
        """Whether all fields have the same values."""
        pairs = ((getattr(self, member.name), getattr(other, member.name)) for member in fields(self))
        return all(np.array_equal(a, b) for a, b in pairs)

    @property
    def row_count(self) -> int:
        """Number of rows of the record's first array."""
        return len(getattr(self, next(iter(array_specs(type(self))))))
