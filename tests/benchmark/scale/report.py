# SPDX-License-Identifier: GPL-3.0-or-later
"""The scale benchmark's tables in Markdown."""

from collections.abc import Mapping

from tests.benchmark.error.report import format_number, table

from .series import SERIES

#: By value of a series: the result of point.measure.
Results = Mapping[int, Mapping]

#: By heading: a column's value, from a point's result. Columns without values in a series are left out.
COLUMNS = {
    "reading s": lambda point: point["reading s"],
    "first sync s": lambda point: point["first sync s"],
    "BVH ms": lambda point: point["BVH ms"],
    "shadows ms": lambda point: point["shadows ms"],
    "shadows with BVH kept ms": lambda point: point["shadows again ms"],
    "first sample s": lambda point: point["first sample s"],
    "further sample s": lambda point: point["further sample s"],
    "a frame s": lambda point: point.get("a frame s"),
    "peak MB": lambda point: point["peak bytes"] / 1e6,
}
COUNTED = (
    "First sync: reading in Blender, and the upload of meshes, instances and materials. Shadows: BVHs, culling, probe "
    "rays, prediction and shadow rays of the first sample. Peak: the most memory in use, OpenGL and shaders included, "
    "above Blender with the scene open. Each row is a process of its own that has compiled its shaders before."
)


def series(name: str, points: Results) -> str:
    """A row for each value."""
    columns = {
        heading: value_of
        for heading, value_of in COLUMNS.items()
        if any(value_of(point) is not None for point in points.values())
    }
    rows = [[SERIES[name].unit, *columns]]
    rows += [[f"{value:,}", *(format_number(of(point)) for of in columns.values())] for value, point in points.items()]
    return f"## {name}\n\n{table(rows)}"
