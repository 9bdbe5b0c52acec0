# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of passes in docs/architecture.md, made from their classes."""

import inspect
from pathlib import Path

from ism_addon.gpu import renderer  # noqa: F401 (it imports all passes)
from ism_addon.gpu.frame import Pass

#: Folders of ism_addon/gpu/passes, in the order of a sample.
STAGES = ("upload", "surfaces", "light_selection", "direct", "shadow_maps", "environment", "emission", "film")


def table() -> str:
    """A row for each pass of the renderer: its stage, its file, and what it makes."""
    rows = ["| stage | pass | file | what it makes |", "|---|---|---|---|"]
    for stage in STAGES:
        passes = [pass_type for pass_type in Pass.__subclasses__() if source_file(pass_type).parent.name == stage]
        rows += [row(stage, pass_type) for pass_type in sorted(passes, key=lambda pass_type: pass_type.__name__)]
    return "\n".join(rows)


def row(stage: str, pass_type: type[Pass]) -> str:
    about = inspect.cleandoc(pass_type.__doc__ or "").partition("\n\n")[0].replace("\n", " ")
    return f"| {stage} | `{pass_type.__name__}` | `{source_file(pass_type).name}` | {about} |"


def source_file(pass_type: type[Pass]) -> Path:
    return Path(inspect.getfile(pass_type))
