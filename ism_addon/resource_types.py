# SPDX-License-Identifier: GPL-3.0-or-later
"""What a resource is: its name, its type, how long it lasts, and of a target the texels."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any, Generic, TypeVar

if TYPE_CHECKING:
    from moderngl import Texture
else:
    Texture = Any

T_co = TypeVar("T_co", covariant=True)


class Lifetime(Enum):
    """How long a resource holds what it does."""

    SCENE = "until what it was made from changes in the scene"
    PICTURE = "state that the samples of a picture build up; a first sample begins it anew"
    SAMPLE = "one sample"


@dataclass(frozen=True, eq=False)
class Resource(Generic[T_co]):
    """What some passes make and others read. One `by_value` is unchanged if it is equal to what it was."""

    name: str
    about: str
    lifetime: Lifetime = Lifetime.SAMPLE
    by_value: bool = False

    def __repr__(self) -> str:
        return self.name


@dataclass(frozen=True, eq=False, repr=False)
class Target(Resource[Texture]):
    """A texture that passes draw into: the size of the picture over `divisor`, or for 0 a size that the pass says.

    Where no pass makes it, a few texels of `neutral` stand for it, so shaders need no variant without it; None: nobody
    reads it then. In strips, texels lie one row of the picture behind the other, see gl/render_targets.py.
    """

    format: str = "rgba32f"
    divisor: int = 1
    strips: bool = False
    neutral: tuple[float, ...] | None = (0.0, 0.0, 0.0, 0.0)
    label: str = ""  # of the debug view, if it is one

    @property
    def components(self) -> int:
        """Of a texel."""
        return 1 if self.is_depth else len(self.format.rstrip("0123456789fui"))

    @property
    def dtype(self) -> str:
        """Of a component, as moderngl calls it: a letter and a number of bytes."""
        bits = self.format.lstrip("rgbadepth")
        kind = "u" if bits.endswith("ui") else "f"
        return f"{kind}{int(bits.rstrip('fui')) // 8}"

    @property
    def is_depth(self) -> bool:
        """Whether it is a depth buffer."""
        return self.format.startswith("depth")

    @property
    def texel_bytes(self) -> int:
        """Of one."""
        return self.components * int(self.dtype[1:])


@dataclass(frozen=True, eq=False, repr=False)
class Channel(Resource[Texture]):
    """A channel of a target that others depend on alone: it may be unchanged where the rest is new."""

    of: Target = field(kw_only=True)
