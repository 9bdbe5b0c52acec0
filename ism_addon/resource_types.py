# SPDX-License-Identifier: GPL-3.0-or-later
"""Types of resources: name, content type and lifetime; for render targets, also the texture format."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any, Generic, TypeVar

if TYPE_CHECKING:
    from moderngl import Texture
else:
    Texture = Any

T_co = TypeVar("T_co", covariant=True)


class Lifetime(Enum):
    """How long the contents of a resource are valid."""

    SCENE = "until its inputs in the scene change"
    PICTURE = "state that the samples of an image build up; a first sample resets it"
    SAMPLE = "one sample"


@dataclass(frozen=True, eq=False)
class Resource(Generic[T_co]):
    """Data that passes make and read. With `by_value`, equal contents count as unchanged."""

    name: str
    about: str
    lifetime: Lifetime = Lifetime.SAMPLE
    by_value: bool = False

    def __repr__(self) -> str:
        return self.name


@dataclass(frozen=True, eq=False, repr=False)
class Target(Resource[Texture]):
    """A render target. Its size is that of the image over `divisor`; 0: the pass allocates it.

    If no pass makes it, readers get a texture of `neutral` texels, so shaders need no variant without it. None: no pass
    reads it in that case. `strips`: layout of targets with a texel per tile, see gl/render_targets.py.
    """

    format: str = "rgba32f"
    divisor: int = 1
    strips: bool = False
    neutral: tuple[float, ...] | None = (0.0, 0.0, 0.0, 0.0)
    label: str = ""  # of the debug view; "": it is none

    @property
    def components(self) -> int:
        """Components of a texel."""
        return 1 if self.is_depth else len(self.format.rstrip("0123456789fui"))

    @property
    def dtype(self) -> str:
        """Type of a component in moderngl's notation: a letter and the number of bytes."""
        bits = self.format.lstrip("rgbadepth")
        letter = "u" if bits.endswith("ui") else "f"
        return f"{letter}{int(bits.rstrip('fui')) // 8}"

    @property
    def is_depth(self) -> bool:
        """Whether it is a depth buffer."""
        return self.format.startswith("depth")

    @property
    def texel_bytes(self) -> int:
        """Bytes of a texel."""
        return self.components * int(self.dtype[1:])


@dataclass(frozen=True, eq=False, repr=False)
class Channel(Resource[Texture]):
    """A channel of a target that is tracked separately: it may be unchanged when the other channels have changed."""

    of: Target = field(kw_only=True)
    label: str = ""  # of the debug view; "": it is none


def targets_of(inputs: Iterable[object]) -> tuple[Target, ...]:
    """The targets among the inputs of a pass, and the targets of channels among them."""
    resources = (each.of if isinstance(each, Channel) else each for each in inputs)
    return tuple(each for each in resources if isinstance(each, Target))
