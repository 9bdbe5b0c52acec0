# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of version 0.1.0 that were replaced by standard terms are not used again."""

import io
import re
import tokenize
from fnmatch import fnmatch
from pathlib import Path

import pytest

from tests.tools import project

from .retired_names import AMBIGUOUS, RETIRED

#: Files that list old names.
EXEMPT = {"ism_addon/old_names.py", "CHANGELOG.md"}
NAMES = {name: new for names, new in RETIRED.items() for name in names.split()}
PYTHON = [name for name in project.files() if name.startswith("ism_addon/") and name.endswith(".py")]
SHADERS = [name for name in project.files() if Path(name).suffix in {".glsl", ".frag", ".vert"}]
TEXTS = [name for name in project.files() if name == "README.md" or name.startswith(("docs/", ".github/"))]
#: Names of benchmarks, which texts mention.
BENCHMARKS = {path.stem for path in (project.ROOT / "tests/benchmark").glob("*.py")}
#: In texts: names in backquotes, and labels.
AS_CODE = re.compile(r"`([\w./]+)`")
LABELS = re.compile(r"\*(?:Fitted|Classic|Surface Points|Light Points|Seen By|Ended By|Memory of Targets)\*")


def identifiers(name: str) -> list[tuple[int, str]]:
    """(line, identifier) of a file's code, without comments and strings."""
    text = (project.ROOT / name).read_text("utf-8")
    if name.endswith(".py"):
        tokens = tokenize.generate_tokens(io.StringIO(text).readline)
        return [(token.start[0], token.string) for token in tokens if token.type == tokenize.NAME]
    lines = enumerate(text.splitlines(), 1)
    return [(line, word) for line, code in lines for word in re.findall(r"[A-Za-z_]\w*", code.partition("//")[0])]


@pytest.mark.parametrize("name", sorted({*PYTHON, *SHADERS} - EXEMPT))
def test_code_has_no_retired_name(name):
    assert [f"{name}:{line}: {old} is {NAMES[old]} now" for line, old in identifiers(name) if old in NAMES] == []


@pytest.mark.parametrize("name", sorted({*PYTHON, *SHADERS}))
def test_ambiguous_words_are_not_used_where_they_were_replaced(name):
    matches = lambda patterns: any(fnmatch(name, pattern) for pattern in patterns)  # noqa: E731
    replaced = {
        word: new
        for words, new, files, exceptions in AMBIGUOUS
        if matches(files) and not matches(exceptions)
        for word in words
    }
    found = identifiers(name) if replaced else []
    assert [f"{name}:{line}: {old} is {replaced[old]} here" for line, old in found if old in replaced] == []


@pytest.mark.parametrize("name", sorted(name for name in TEXTS if name.endswith((".md", ".yml"))))
def test_texts_have_no_retired_name(name):
    text = (project.ROOT / name).read_text("utf-8")
    assert [old for old in AS_CODE.findall(text) if old in NAMES and old not in BENCHMARKS] == []
    assert LABELS.findall(text) == []


def test_files_have_no_retired_name():
    stems = {Path(name).stem for name in project.files() if name.startswith("ism_addon/")}
    retired = {"cores", "reach", "scout", "sift", "wanted", "lattice", "studio", "worker", "lookout", "geometry"}
    assert not stems & (retired | {"faults", "faces", "findings", "borrowed", "account", "controls", "extract"})
