# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of passes in docs/architecture.md, made from their classes."""

import inspect
from pathlib import Path

from ism_addon.gpu import renderer  # noqa: F401 (it imports all passes)
from ism_addon.gpu.frame import Pass

#: Folders of ism_addon/gpu/passes, in the order in which a sample goes through them.
STAGES = ("upload", "surfaces", "light_selection", "direct", "shadow_maps", "environment", "film")


def table() -> str:
    """A row for each pass of the renderer: its stage, where its Python and GLSL are, and what it makes."""
    rows = ["| stage | pass | file | what it makes |", "|---|---|---|---|"]
    for stage in STAGES:
        passes = [step for step in Pass.__subclasses__() if place(step).parent.name == stage]
        rows += [row(stage, step) for step in sorted(passes, key=lambda step: step.__name__)]
    return "\n".join(rows)


def row(stage: str, step: type[Pass]) -> str:
    about = inspect.cleandoc(step.__doc__ or "").partition("\n\n")[0].replace("\n", " ")
    return f"| {stage} | `{step.__name__}` | `{place(step).name}` | {about} |"


def place(step: type[Pass]) -> Path:
    """Of its file."""
    return Path(inspect.getfile(step))
