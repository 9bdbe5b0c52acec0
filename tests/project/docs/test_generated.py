# SPDX-License-Identifier: GPL-3.0-or-later
"""Generated parts of the documentation are up to date. `python3 dev.py docs` generates them."""

import re

import pytest

from ism_addon.settings import SECTIONS
from ism_addon.settings.setting_fields import setting_fields
from tests.docs import generated, plot, record
from tests.tools import project

#: Limits of the README's length.
MAX_LINES, MAX_CHARACTERS = 150, 9000


@pytest.mark.parametrize(("path", "content"), list(generated.current()), ids=lambda value: getattr(value, "name", ""))
def test_generated_parts_are_current(path, content):
    assert path.read_text("utf-8") == content, "run python3 dev.py docs"


def test_every_part_is_used():
    found = {name for page in generated.pages() for name in generated.PART.findall(page.read_text("utf-8"))}
    assert found == set(generated.PARTS)


def test_a_part_that_nothing_generates_is_an_error():
    with pytest.raises(KeyError, match="weather"):
        generated.filled("<!-- generated: weather -->\n<!-- end -->")


def test_every_setting_is_in_its_page():
    page = (project.ROOT / "docs" / "settings.md").read_text("utf-8")
    assert all(f"| `{member.name}` |" in page for section in SECTIONS.values() for member, _ in setting_fields(section))


def test_the_readme_is_short():
    text = (project.ROOT / "README.md").read_text("utf-8")
    assert text.count("\n") <= MAX_LINES
    assert len(text) <= MAX_CHARACTERS


@pytest.mark.parametrize("path", sorted(record.FOLDER.glob("*.json")), ids=lambda path: path.stem)
def test_a_record_states_its_origin(path):
    found = record.read(path.stem)
    assert re.fullmatch(
        r"Recorded \d{4}-\d\d-\d\d by `python3 dev\.py bench \w+.*`, commit \w+\+?: \d+ cores of .+, .+[;.].*",
        record.sentence(found),
    )


def test_no_measured_number_is_outside_of_generated_parts():
    """Measured times, sizes and errors are generated from records, never typed by hand."""
    by_hand = []
    for page in generated.pages():
        text = generated.PART.sub("", page.read_text("utf-8"))
        by_hand += [f"{page.name}: {found}" for found in re.findall(r"\b\d+(?:\.\d+)? (?:ms|s|MB|GB|%)(?!\w)", text)]
    assert by_hand == []


def test_a_plot_contains_its_points_and_is_deterministic():
    panel = plot.Panel("a < b", "seconds", "error", {"ours": [(0.1, 1.0), (1.0, 0.1)], "theirs": [(0.2, 2.0)]})
    svg = plot.svg([panel], columns=1)
    assert svg == plot.svg([panel], columns=1)
    assert svg.count("<circle") == 3
    assert "a &lt; b" in svg
    assert "".join(plot.svg([panel, panel], columns=2)).count("<polyline") == 4
