# SPDX-License-Identifier: GPL-3.0-or-later
"""The inputs of materials in the G-buffer, and the GLSL that writes and reads them there.

The base color has a separate target, as images may be its source. The components of all other inputs are packed in
MATERIAL_VALUES.
"""

from typing import Any

from ..resource_types import Resource
from ..resources import BASE_COLOR, MATERIAL_VALUES
from ..scene import MATERIAL_INPUTS
from .frame import Frame
from .gl import shader_compiler

#: Among the inputs of passes whose shaders read Surface.material.
MATERIAL: tuple[Resource[Any], ...] = BASE_COLOR, *MATERIAL_VALUES

#: All inputs but the base color.
OTHERS = {name: each for name, each in MATERIAL_INPUTS.items() if name != BASE_COLOR.name}


def material_samplers(frame: Frame) -> dict[str, Any]:
    """Samplers by name."""
    return {target.name: frame[target] for target in MATERIAL}


def components() -> dict[str, list[str]]:
    """GLSL names of each input's components: material_values_0.x, …"""
    names, first = {}, 0
    for name, each in OTHERS.items():
        indices = range(first, first + each.components)
        names[name] = [f"{MATERIAL_VALUES[k // 4].name}.{'xyzw'[k % 4]}" for k in indices]
        first += each.components
    return names


def reading(_constants: shader_compiler.Constants) -> str:
    """The generated file surfaces/material_inputs.glsl: reads a pixel's material."""
    members = [f"    {each.glsl_type} {name};" for name, each in MATERIAL_INPUTS.items()]
    fetches = [f"    vec4 at_{target.name} = fetch({target.name}, at);" for target in MATERIAL_VALUES]
    values = {
        name: f"{OTHERS[name].glsl_type}({', '.join(f'at_{component}' for component in names)})"
        for name, names in components().items()
    }
    return "\n".join(
        [
            *("struct MaterialInputs {", *members, "};"),
            *(f"uniform sampler2D {target.name};" for target in MATERIAL_VALUES),
            *("MaterialInputs material_inputs_at(ivec2 at, vec3 base_color) {", *fetches),
            f"    return MaterialInputs({', '.join(values.get(name, name) for name in MATERIAL_INPUTS)});",
            "}",
        ]
    )


def writing(_constants: shader_compiler.Constants) -> str:
    """The generated file surfaces/material_outputs.glsl: outputs of the G-buffer, at locations that it defines."""
    outputs = [
        f"layout(location = {target.name.upper()}_LOCATION) out vec4 {target.name};" for target in MATERIAL_VALUES
    ]
    clear = [f"    {target.name} = vec4(0.0);" for target in MATERIAL_VALUES]
    write = [
        f"    {component} = material.{name}{f'[{k}]' if len(names) > 1 else ''};"
        for name, names in components().items()
        for k, component in enumerate(names)
    ]
    return "\n".join(
        [
            *(*outputs, "void clear_material_inputs() {", *clear, "}"),
            *("void write_material_inputs(Material material) {", *write, "}"),
        ]
    )


shader_compiler.GENERATED["surfaces/material_inputs.glsl"] = reading
shader_compiler.GENERATED["surfaces/material_outputs.glsl"] = writing
