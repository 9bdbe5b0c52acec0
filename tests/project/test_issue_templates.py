# SPDX-License-Identifier: GPL-3.0-or-later
"""Issue templates ask for a snapshot and for the statistics, by the names that Blender shows."""

import re

import pytest

from ism_addon.blender.operators import ISM_OT_save_snapshot
from ism_addon.ui.developer import ISM_RENDER_PT_developer
from ism_addon.ui.statistics import ISM_RENDER_PT_statistics
from tests.tools import project

TEMPLATES = sorted((project.ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.md"))
MENU = f"Render properties › {ISM_RENDER_PT_developer.bl_label} ›"


def test_there_are_templates():
    assert TEMPLATES


@pytest.mark.parametrize("path", TEMPLATES, ids=lambda path: path.stem)
def test_a_template_asks_for_a_snapshot_and_statistics(path):
    text = path.read_text("utf-8")
    head = re.match(r"---\nname: (.+)\nabout: (.+)\ntitle: .*\nlabels: (\w+)\n---\n", text)
    assert head is not None, "GitHub needs these lines to offer a template"
    assert f"{MENU} {ISM_OT_save_snapshot.bl_label}" in text
    assert f"{MENU} {ISM_RENDER_PT_statistics.bl_label}" in text
    for page in re.findall(r"docs/[\w-]+\.md", text):
        assert (project.ROOT / page).exists()
