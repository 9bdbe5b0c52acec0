# SPDX-License-Identifier: GPL-3.0-or-later
# ruff: noqa: N801 (Blender's rule for the names of panels)
"""The panel with the statistics of the latest render."""

from collections.abc import Sequence

import bpy

from .developer import ISM_RENDER_PT_developer
from .panels import ISMPanel

USES = {"viewport": "Viewport", "render": "Final Render"}
STOP_REASONS = {"samples": "Samples", "error": "Error Threshold", "time": "Time Limit", "": ""}
COLUMNS = ("Pass", "Drawn", "Reused", "Skipped", "ms")


def latest() -> tuple[str, dict]:
    """The latest render's use and statistics. The engine is found by name, because `ui` does not import it."""
    return bpy.types.RenderEngine.bl_rna_get_subclass_py("ISM").latest_statistics()


def passes(statistics: dict) -> list[tuple[str, ...]]:
    """A row for each pass: name, times drawn, reused and skipped, milliseconds."""
    return [
        (name, *(f"{row[count]:,}" for count in ("drawn", "reused", "skipped")), f"{row['ms']:,.1f}")
        for name, row in statistics["passes"].items()
    ]


def counts(statistics: dict) -> list[tuple[str, str]]:
    """Labels and texts of all other statistics that are not 0."""
    megabytes = {name: f"{statistics[name] / 2**20:,.1f} MB" for name in ("bytes_uploaded", "render_target_bytes")}
    rows = [
        ("Samples", "samples", f"{statistics['samples']:,}"),
        ("Time", "seconds", f"{statistics['seconds']:.2f} s"),
        ("Stopped By", "stopped_by", STOP_REASONS[statistics["stopped_by"]]),
        (
            "Estimated Error",
            "error",
            f"{100.0 * statistics['error']:.2f} %" if statistics["samples"] > 1 else "unknown",
        ),
        ("Triangles", "triangles", f"{statistics['triangles']:,}"),
        ("Triangles Drawn", "triangles_drawn", f"{statistics['triangles_drawn']:,}"),
        ("Pixels Drawn", "pixels_drawn", f"{statistics['pixels_drawn']:,}"),
        ("Lights Used", "lights_used", f"{statistics['lights_used']:,}"),
        ("Pixel–Light Pairs Traced", "pairs_traced", f"{statistics['pairs_traced']:,}"),
        ("Occlusion Retests", "retests", f"{statistics['retests']:,}"),
        ("Virtual Point Lights", "virtual_lights", f"{statistics['virtual_lights']:,}"),
        ("Points per Map", "map_points", f"{statistics['map_points']:,}"),
        ("Uploaded", "bytes_uploaded", megabytes["bytes_uploaded"]),
        ("Render Target Memory", "render_target_bytes", megabytes["render_target_bytes"]),
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
        """Texts in columns: the first one left-aligned, the others right-aligned."""
        grid = self.layout.grid_flow(row_major=True, columns=columns, align=True)
        for row in rows:
            for column, text in enumerate(row):
                cell = grid.row()
                cell.alignment = "RIGHT" if column else "LEFT"
                cell.label(text=text)


register, unregister = bpy.utils.register_classes_factory((ISM_RENDER_PT_statistics,))
