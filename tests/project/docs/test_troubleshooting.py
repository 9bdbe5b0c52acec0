# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/troubleshooting.md has every sentence that a user can meet, and none that nobody says any more."""

import re

from tests.docs.sentences import sentences
from tests.tools import project

PAGE = (project.ROOT / "docs" / "troubleshooting.md").read_text("utf-8")
LISTED = [line[2:-2] for line in PAGE.splitlines() if re.fullmatch(r"\*\*.+\*\*", line)]


def test_every_sentence_of_the_code_stands_in_it():
    assert {text: module for text, module in sentences().items() if text not in LISTED} == {}


def test_every_sentence_in_it_is_one_of_the_code():
    assert set(LISTED) - set(sentences()) == set()


def test_none_stands_there_twice():
    assert len(LISTED) == len(set(LISTED))


def test_each_is_followed_by_what_to_do():
    paragraphs = [part.strip() for part in PAGE.split("\n\n")]
    for sentence, after in zip(paragraphs, [*paragraphs[1:], ""], strict=True):
        assert not sentence.startswith("**") or not after.startswith("#"), f"{sentence} has no advice"
