# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds commands and scripts in README.md and docs."""

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass

from .generated import pages

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.M | re.S)
#: In running text: code that begins like a command.
INLINE = re.compile(r"`((?:python3|blender|apt-get) [^`]+|python -m [^`]+)`")


@dataclass(frozen=True)
class Command:
    """One shell command."""

    page: str
    line: str

    @property
    def words(self) -> list[str]:
        """The command's words, without environment variables set before it."""
        words = shlex.split(self.line, comments=True)
        while words and re.fullmatch(r"[A-Z_]+=.*", words[0]):
            words.pop(0)
        return words

    @property
    def options(self) -> set[str]:
        return {word for word in self.words if word.startswith("-")}

    def __str__(self) -> str:
        return f"{self.page}: {self.line}"


def commands() -> Iterator[Command]:
    """All commands, each once per page."""
    for page in pages():
        text = page.read_text("utf-8")
        lines = [line for language, code in BLOCK.findall(text) if language == "sh" for line in code.splitlines()]
        lines += [" ".join(inline.split()) for inline in INLINE.findall(BLOCK.sub("", text))]
        yield from (Command(page.name, line) for line in dict.fromkeys(filter(None, lines)))


def scripts() -> dict[str, str]:
    """By page: all of its blocks of Python, joined."""
    result = {}
    for page in pages():
        blocks = [code for language, code in BLOCK.findall(page.read_text("utf-8")) if language == "python"]
        if blocks:
            result[page.name] = "\n".join(blocks)
    return result


def other_languages() -> set[str]:
    """Languages of code blocks other than shell and Python, which no test runs."""
    languages = {language for page in pages() for language, _ in BLOCK.findall(page.read_text("utf-8"))}
    return languages - {"sh", "python"}
