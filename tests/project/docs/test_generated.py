# SPDX-License-Identifier: GPL-3.0-or-later
"""What is generated stands in the pages as it would be generated now; `python3 dev.py docs` writes it anew."""

import re

import pytest

from ism_addon.settings import SECTIONS, setting_fields
from tests.docs import generated, plot, record
from tests.tools import project

#: Of the README, at most.
LINES, CHARACTERS = 150, 9000


@pytest.mark.parametrize(("path", "content"), list(generated.current()), ids=lambda value: getattr(value, "name", ""))
def test_generated_parts_are_current(path, content):
    assert path.read_text("utf-8") == content, "run python3 dev.py docs"


def test_every_part_stands_somewhere():
    found = {name for page in generated.pages() for name in generated.PART.findall(page.read_text("utf-8"))}
    assert found == set(generated.PARTS)


def test_a_part_that_nothing_generates_is_an_error():
    with pytest.raises(KeyError, match="weather"):
        generated.filled("<!-- generated: weather -->\n<!-- end -->")


def test_every_setting_stands_in_its_page():
    page = (project.ROOT / "docs" / "settings.md").read_text("utf-8")
    assert all(f"| `{member.name}` |" in page for section in SECTIONS.values() for member, _ in setting_fields(section))


def test_the_readme_is_short():
    text = (project.ROOT / "README.md").read_text("utf-8")
    assert text.count("\n") <= LINES
    assert len(text) <= CHARACTERS


@pytest.mark.parametrize("path", sorted(record.FOLDER.glob("*.json")), ids=lambda path: path.stem)
def test_a_record_says_where_it_comes_from(path):
    found = record.read(path.stem)
    assert re.fullmatch(
        r"Recorded \d{4}-\d\d-\d\d by `python3 dev\.py bench \w+.*`, commit \w+\+?: \d+ cores of .+, .+, Blender .+\.",
        record.sentence(found),
    )


def test_numbers_outside_of_generated_parts_are_not_those_of_records():
    """No measured time or error is typed by hand: outside of the parts no page has one."""
    typed = []
    for page in generated.pages():
        text = generated.PART.sub("", page.read_text("utf-8"))
        typed += [f"{page.name}: {found}" for found in re.findall(r"\b\d+(?:\.\d+)? (?:ms|s|MB|GB|%)(?!\w)", text)]
    assert typed == []


def test_a_plot_holds_its_points_and_the_same_ones_give_the_same_bytes():
    panel = plot.Panel("a < b", "seconds", "error", {"ours": [(0.1, 1.0), (1.0, 0.1)], "theirs": [(0.2, 2.0)]})
    drawn = plot.svg([panel], columns=1)
    assert drawn == plot.svg([panel], columns=1)
    assert drawn.count("<circle") == 3
    assert "a &lt; b" in drawn
    assert "".join(plot.svg([panel, panel], columns=2)).count("<polyline") == 4
