# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands and scripts in README.md and docs."""

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass

from .generated import pages

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.M | re.S)
#: In running text: what begins like a command.
INLINE = re.compile(r"`((?:python3|blender|apt-get) [^`]+|python -m [^`]+)`")


@dataclass(frozen=True)
class Command:
    """One line of a shell."""

    page: str
    line: str

    @property
    def words(self) -> list[str]:
        """Without variables of the environment that stand before it."""
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
    """All of them, each once a page."""
    for page in pages():
        text = page.read_text("utf-8")
        lines = [line for kind, code in BLOCK.findall(text) if kind == "sh" for line in code.splitlines()]
        lines += [" ".join(found.split()) for found in INLINE.findall(BLOCK.sub("", text))]
        yield from (Command(page.name, line) for line in dict.fromkeys(filter(None, lines)))


def scripts() -> dict[str, str]:
    """Of each page with Python in it: all of its blocks, one after the other."""
    found = {}
    for page in pages():
        blocks = [code for kind, code in BLOCK.findall(page.read_text("utf-8")) if kind == "python"]
        if blocks:
            found[page.name] = "\n".join(blocks)
    return found


def other_languages() -> set[str]:
    """What else stands in blocks, which nothing runs."""
    kinds = {kind for page in pages() for kind, _ in BLOCK.findall(page.read_text("utf-8"))}
    return kinds - {"sh", "python"}
