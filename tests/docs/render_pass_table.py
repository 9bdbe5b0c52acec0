# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of render passes in docs/scripting.md, made from render_passes.py."""

from ism_addon.render_passes import RENDER_PASSES, RenderPass

EVERY_SAMPLE, FIRST_SAMPLE = "all samples, filtered", "the first sample"


def table() -> str:
    rows = ["| render pass | switch of the view layer | channels | of | flag |", "|---|---|---|---|---|"]
    return "\n".join([*rows, *map(row, RENDER_PASSES)])


def row(each: RenderPass) -> str:
    switch = f"`{each.switch}`" if each.switch else "always there"
    samples = EVERY_SAMPLE if each.filtered else FIRST_SAMPLE
    return f"| {each.name} | {switch} | {each.channels} | {samples} | `--output-{each.identifier}` |"
