# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials. The declaration of an input determines how it is read, stored in snapshots and passed to shaders."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from .arrays import Arrays, ArraySpec, array, index, optional_array
from .limits import MAX_DISTANCE, MAX_EMISSION


@dataclass(frozen=True)
class MaterialInput:
    """Declaration of an input: a number or a color."""

    spec: ArraySpec
    default: float  # for materials without a shader, and instead of values that are not numbers
    sockets: Mapping[str, str]  # of Blender's shader nodes, by the nodes' bl_idname

    @property
    def components(self) -> int:
        """1 for a number, 3 for a color."""
        return int(self.spec.shapes[0][-1]) if len(self.spec.shapes[0]) > 1 else 1

    @property
    def glsl_type(self) -> str:
        """Type of the member with the field's name in Material and Surface."""
        return "float" if self.components == 1 else f"vec{self.components}"


def material_input(layout: str, default: float, sockets: Mapping[str, str], max_abs: float | None = None) -> Any:
    """A field of Materials that is an input."""
    spec = ArraySpec(layout, max_abs=max_abs)
    return field(metadata={"array": spec, "input": MaterialInput(spec, default, sockets)})


@dataclass(frozen=True, eq=False)
class Materials(Arrays):
    """Lambertian materials: a base color, or an image or a graph instead; and the light that both sides emit."""

    base_color: np.ndarray = material_input(
        "float32 M 3",
        0.8,  # Blender's grey of surfaces without a material
        {"ShaderNodeBsdfPrincipled": "Base Color", "ShaderNodeBsdfDiffuse": "Color"},
        max_abs=MAX_DISTANCE,
    )
    #: -1: no image.
    image: np.ndarray = index("int32 M", into="images", first=-1)
    #: Radiance, the same in all directions; about the mean of one that varies.
    emission: np.ndarray = array("float32 M 3", "W/(sr m²)", max_abs=MAX_EMISSION)
    #: -1: no graph. The base color is then that of a material whose graph cannot be drawn.
    graph: np.ndarray = index("int32 M", into="graphs", first=-1)
    #: The first of a graph's constants, see NodeGraph.locations; -1 without constants.
    first_constant: np.ndarray = index("int32 M", into="constants", first=-1)
    #: Of all materials.
    constants: np.ndarray = array("float32 K 4")
    #: For camera rays and for shadow rays: the graph of what passes, -1 if nothing does, and the first of its
    #: constants. Without rows if all materials are opaque.
    transparency: np.ndarray = optional_array("int32 T 2", into="graphs", first=-1)
    transparency_constant: np.ndarray = optional_array("int32 T 2", into="constants", first=-1)
    #: The graph of the radiance, and of what passes if the camera sees through it; -1 where the radiance is `emission`;
    #: and the first of its constants. Without rows if none varies.
    emission_graph: np.ndarray = optional_array("int32 E", into="graphs", first=-1)
    emission_constant: np.ndarray = optional_array("int32 E", into="constants", first=-1)


#: Inputs by name.
MATERIAL_INPUTS: dict[str, MaterialInput] = {
    member.name: member.metadata["input"] for member in fields(Materials) if "input" in member.metadata
}
