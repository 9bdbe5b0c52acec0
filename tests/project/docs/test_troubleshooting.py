# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/troubleshooting.md lists exactly the messages that the code can show to users."""

import re

from tests.docs.sentences import sentences
from tests.tools import project

PAGE = (project.ROOT / "docs" / "troubleshooting.md").read_text("utf-8")
LISTED = [line[2:-2] for line in PAGE.splitlines() if re.fullmatch(r"\*\*.+\*\*", line)]


def test_every_message_of_the_code_is_listed():
    assert {text: module for text, module in sentences().items() if text not in LISTED} == {}


def test_every_listed_message_is_in_the_code():
    assert set(LISTED) - set(sentences()) == set()


def test_no_message_is_listed_twice():
    assert len(LISTED) == len(set(LISTED))


def test_each_message_is_followed_by_advice():
    paragraphs = [part.strip() for part in PAGE.split("\n\n")]
    for sentence, after in zip(paragraphs, [*paragraphs[1:], ""], strict=True):
        assert not sentence.startswith("**") or not after.startswith("#"), f"{sentence} has no advice"
