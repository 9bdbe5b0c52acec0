# SPDX-License-Identifier: GPL-3.0-or-later
"""The generated parts of README.md and docs: each stands between two markers that name it."""

import re
from collections.abc import Iterator
from pathlib import Path

from tests.tools import project

from . import benchmark_tables, limits_table, pass_list, render_pass_table, settings_table

PARTS = {
    **benchmark_tables.PARTS,
    "settings": settings_table.tables,
    "limits": limits_table.table,
    "pass list": pass_list.table,
    "render passes": render_pass_table.table,
}
PART = re.compile(r"<!-- generated: ([\w ]+) -->\n.*?<!-- end -->", re.S)


def pages() -> list[Path]:
    """All that is documentation."""
    return [project.ROOT / "README.md", *sorted((project.ROOT / "docs").glob("*.md"))]


def filled(text: str) -> str:
    """A page with its parts as they are generated now. Raises KeyError for a part that nothing generates."""
    return PART.sub(lambda found: f"<!-- generated: {found[1]} -->\n\n{PARTS[found[1]]()}\n\n<!-- end -->", text)


def current() -> Iterator[tuple[Path, str]]:
    """What each page and plot should hold."""
    for page in pages():
        yield page, filled(page.read_text("utf-8"))
    for name, draw in benchmark_tables.PLOTS.items():
        yield project.ROOT / name, draw()


def write() -> list[Path]:
    """Write what is not as it should be: its paths."""
    written = []
    for path, content in current():
        if not path.exists() or path.read_text("utf-8") != content:
            path.write_text(content, "utf-8")
            written.append(path)
    return written
