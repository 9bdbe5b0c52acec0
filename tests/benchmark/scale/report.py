# SPDX-License-Identifier: GPL-3.0-or-later
"""The measurements as tables in Markdown."""

from collections.abc import Mapping

from tests.benchmark.error.report import number, table

from .series import SERIES

#: Of each value of a series: what point.measure found.
Results = Mapping[int, Mapping]

#: Headings and how a point tells what is under them; a heading that no point of a series knows is left out.
COLUMNS = {
    "reading s": lambda told: told["reading s"],
    "first sync s": lambda told: told["first sync s"],
    "BVH ms": lambda told: told["trees ms"],
    "shadows ms": lambda told: told["shadows ms"],
    "shadows with BVH kept ms": lambda told: told["shadows again ms"],
    "first sample s": lambda told: told["first sample s"],
    "further sample s": lambda told: told["further sample s"],
    "a frame s": lambda told: told.get("a frame s"),
    "peak MB": lambda told: told["peak bytes"] / 1e6,
}
COUNTED = (
    "First sync: reading in Blender, and the upload of meshes, instances and materials. Shadows: BVHs, culling, probe "
    "rays, prediction and shadow rays of the first sample. Peak: the most memory in use, OpenGL and shaders included, "
    "above Blender with the scene open. Each row is a process of its own that has compiled its shaders before."
)


def series(name: str, points: Results) -> str:
    """A row for each value."""
    known = {heading: of for heading, of in COLUMNS.items() if any(of(told) is not None for told in points.values())}
    rows = [[SERIES[name].unit, *known]]
    rows += [[f"{value:,}", *(number(of(told)) for of in known.values())] for value, told in points.items()]
    return f"## {name}\n\n{table(rows)}"
