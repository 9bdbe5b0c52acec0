# SPDX-License-Identifier: GPL-3.0-or-later
"""Generates the parts of README.md and docs that are between two markers with their name."""

import re
from collections.abc import Iterator
from pathlib import Path

from tests.tools import project

from . import (
    benchmark_tables,
    limits_table,
    node_table,
    pass_list,
    render_pass_table,
    settings_table,
    sphere_table,
    world_table,
)

PARTS = {
    **benchmark_tables.PARTS,
    "nodes": node_table.node_table,
    "spheres": sphere_table.sphere_table,
    "worlds": world_table.world_table,
    "settings": settings_table.tables,
    "limits": limits_table.table,
    "pass list": pass_list.table,
    "render passes": render_pass_table.table,
}
PART = re.compile(r"<!-- generated: ([\w ]+) -->\n.*?<!-- end -->", re.S)


def pages() -> list[Path]:
    """All pages of the documentation."""
    return [project.ROOT / "README.md", *sorted((project.ROOT / "docs").glob("*.md"))]


def filled(text: str) -> str:
    """A page with its parts generated anew. Raises KeyError for a part without a generator."""
    return PART.sub(lambda match: f"<!-- generated: {match[1]} -->\n\n{PARTS[match[1]]()}\n\n<!-- end -->", text)


def current() -> Iterator[tuple[Path, str]]:
    """Each page and plot, and its content as generated now."""
    for page in pages():
        yield page, filled(page.read_text("utf-8"))
    for name, plot in benchmark_tables.PLOTS.items():
        yield project.ROOT / name, plot()


def write() -> list[Path]:
    """Write all pages and plots that have changed. Returns their paths."""
    written = []
    for path, content in current():
        if not path.exists() or path.read_text("utf-8") != content:
            path.write_text(content, "utf-8")
            written.append(path)
    return written
