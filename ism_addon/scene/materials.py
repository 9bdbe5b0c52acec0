# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials: each input is a field, from which its reader, its place in snapshots and in shaders follow."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from .arrays import ArrayFacts, Arrays, index
from .limits import MAX_DISTANCE


@dataclass(frozen=True)
class MaterialInput:
    """Declaration of an input: a number, or a color."""

    facts: ArrayFacts
    default: float  # of materials without a shader, and in place of what is no number
    sockets: Mapping[str, str]  # of Blender's shader nodes, by their bl_idname

    @property
    def components(self) -> int:
        """1, or 3 of a color."""
        return int(self.facts.shapes[0][-1]) if len(self.facts.shapes[0]) > 1 else 1

    @property
    def glsl_type(self) -> str:
        """Of the member of Material and Surface that has the field's name."""
        return "float" if self.components == 1 else f"vec{self.components}"


def material_input(layout: str, default: float, sockets: Mapping[str, str], most: float | None = None) -> Any:
    """A field of Materials that is an input."""
    facts = ArrayFacts(layout, most=most)
    return field(metadata={"array": facts, "input": MaterialInput(facts, default, sockets)})


@dataclass(frozen=True, eq=False)
class Materials(Arrays):
    """Lambertian materials: a base color, or an image in its place."""

    base_color: np.ndarray = material_input(
        "float32 M 3",
        0.8,  # Blender's grey of what has no material
        {"ShaderNodeBsdfPrincipled": "Base Color", "ShaderNodeBsdfDiffuse": "Color"},
        most=MAX_DISTANCE,
    )
    #: -1: none.
    image: np.ndarray = index("int32 M", into="images", first=-1)


#: By name.
MATERIAL_INPUTS: dict[str, MaterialInput] = {
    member.name: member.metadata["input"] for member in fields(Materials) if "input" in member.metadata
}
