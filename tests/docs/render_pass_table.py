# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of render passes in docs/scripting.md, made from render_passes.py."""

from ism_addon.render_passes import RENDER_PASSES, RenderPass

EVERY_SAMPLE, FIRST_SAMPLE = "all samples, filtered", "the first sample"


def table() -> str:
    rows = ["| render pass | switch of the view layer | channels | of | flag |", "|---|---|---|---|---|"]
    return "\n".join([*rows, *map(row, RENDER_PASSES)])


def row(render_pass: RenderPass) -> str:
    switch = f"`{render_pass.switch}`" if render_pass.switch else "always there"
    samples = EVERY_SAMPLE if render_pass.filtered else FIRST_SAMPLE
    return (
        f"| {render_pass.name} | {switch} | {render_pass.channels} | {samples} | `--output-{render_pass.identifier}` |"
    )
