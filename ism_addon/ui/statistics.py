# SPDX-License-Identifier: GPL-3.0-or-later
# ruff: noqa: N801 (Blender's rule for the names of panels)
"""The panel that says what the latest picture took, as the engine tells."""

from collections.abc import Sequence

import bpy

from .developer import ISM_RENDER_PT_developer
from .panels import ISMPanel

USES = {"viewport": "Viewport", "render": "Final Render"}
ENDS = {"samples": "Samples", "error": "Error Threshold", "time": "Time Limit", "": ""}
COLUMNS = ("Pass", "Drawn", "Reused", "Skipped", "ms")


def latest() -> tuple[str, dict]:
    """Of which picture, and what it took: asked of the engine by its name, since this floor does not know it."""
    return bpy.types.RenderEngine.bl_rna_get_subclass_py("ISM").latest_statistics()


def passes(statistics: dict) -> list[tuple[str, ...]]:
    """A row a pass that was drawn, reused or skipped."""
    return [
        (name, *(f"{row[count]:,}" for count in ("drawn", "reused", "skipped")), f"{row['ms']:,.1f}")
        for name, row in statistics["passes"].items()
    ]


def counts(statistics: dict) -> list[tuple[str, str]]:
    """What else there is to count, without what there is none of."""
    megabytes = {name: f"{statistics[name] / 2**20:,.1f} MB" for name in ("bytes_uploaded", "bytes_of_targets")}
    rows = [
        ("Samples", "samples", f"{statistics['samples']:,}"),
        ("Time", "seconds", f"{statistics['seconds']:.2f} s"),
        ("Ended By", "ended_by", ENDS[statistics["ended_by"]]),
        (
            "Estimated Error",
            "error",
            f"{100.0 * statistics['error']:.2f} %" if statistics["samples"] > 1 else "unknown",
        ),
        ("Triangles", "triangles", f"{statistics['triangles']:,}"),
        ("Triangles Drawn", "triangles_drawn", f"{statistics['triangles_drawn']:,}"),
        ("Pixels Drawn", "pixels_drawn", f"{statistics['pixels_drawn']:,}"),
        ("Lights Used", "lights_used", f"{statistics['lights_used']:,}"),
        ("Pixels Refined", "pixels_refined", f"{statistics['pixels_refined']:,}"),
        ("Pixels Checked", "pixels_checked", f"{statistics['pixels_checked']:,}"),
        ("Virtual Point Lights", "virtual_lights", f"{statistics['virtual_lights']:,}"),
        ("Points per Map", "map_points", f"{statistics['map_points']:,}"),
        ("Uploaded", "bytes_uploaded", megabytes["bytes_uploaded"]),
        ("Memory of Targets", "bytes_of_targets", megabytes["bytes_of_targets"]),
    ]
    return [(label, text) for label, name, text in rows if statistics[name]]


class ISM_RENDER_PT_statistics(ISMPanel, bpy.types.Panel):
    bl_label = "Statistics"
    bl_parent_id = ISM_RENDER_PT_developer.__name__
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, _context: bpy.types.Context) -> None:
        use, statistics = latest()
        if not statistics:
            self.layout.label(text="Nothing has been drawn yet", icon="INFO")
            return
        self.layout.label(text=USES[use])
        self.table(counts(statistics), columns=2)
        self.table([COLUMNS, *passes(statistics)], columns=len(COLUMNS))

    def table(self, rows: Sequence[tuple[str, ...]], columns: int) -> None:
        """Texts in columns, the first to the left and numbers to the right."""
        grid = self.layout.grid_flow(row_major=True, columns=columns, align=True)
        for row in rows:
            for column, text in enumerate(row):
                cell = grid.row()
                cell.alignment = "RIGHT" if column else "LEFT"
                cell.label(text=text)


register, unregister = bpy.utils.register_classes_factory((ISM_RENDER_PT_statistics,))
