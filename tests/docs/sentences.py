# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds every message that users may see in the code: what is raised, reported, noted about a scene or printed.

Values inserted into a message, such as names or numbers, are replaced by "…".
"""

import ast
import re
from collections.abc import Iterator

from tests.tools import project

ADDON = project.ROOT / "ism_addon"

#: Functions, by name, that show users an argument: its index, or its keyword.
CALLS: dict[str, int | str] = {"warn": 0, "report": 1, "end": 1, "notify": "error", "label": "text", "value": 2}
#: Variables that hold only messages or issues. Texts of tuples and dictionaries are messages too.
NAMES = {"issue", "kind", "why", "sentence", "ALWAYS", "PLAIN", "LEFT_OUT", "OWN_VALUE", "OPEN", "NOTE", "note"}
#: A text with fewer words is a name or a part of a message.
MIN_WORDS = 3
#: Exceptions that users never see: programming errors, and those that are always caught.
INTERNAL = {"NotImplementedError", "_Cancelled", "Cancelled", "KeyError", "TypeError"}


def sentences() -> dict[str, str]:
    """Each message, and the module that it is in."""
    result: dict[str, str] = {}
    for path in sorted(ADDON.rglob("*.py")):
        module = path.relative_to(ADDON).with_suffix("").as_posix()
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            for value in shown_values(node):
                result |= {text: module for text in texts(value) if is_sentence(text)}
    return result


def shown_values(node: ast.AST) -> Iterator[ast.expr | None]:
    """The expressions of a statement or call that are shown to users."""
    if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and name(node.exc.func) not in INTERNAL:
        yield from node.exc.args[:1]
    elif isinstance(node, ast.Call):
        argument = CALLS.get(name(node.func))
        if isinstance(argument, int):
            yield from node.args[argument : argument + 1]
        elif argument:
            yield from (keyword.value for keyword in node.keywords if keyword.arg == argument)
    elif isinstance(node, ast.Return | ast.Yield) or NAMES & set(map(name, assignment_targets(node))):
        yield node.value


def assignment_targets(node: ast.AST) -> list[ast.expr]:
    """The targets of an assignment."""
    if isinstance(node, ast.AnnAssign | ast.AugAssign):
        return [node.target]
    return node.targets if isinstance(node, ast.Assign) else []


def texts(value: ast.AST | None) -> Iterator[str]:
    """Texts in an expression, with "…" for inserted values."""
    if isinstance(value, ast.Constant) and isinstance(value.value, str):
        yield re.sub(r"\{\d?\}", "…", value.value)
    elif isinstance(value, ast.JoinedStr):
        parts = (part.value if isinstance(part, ast.Constant) else "…" for part in value.values)
        yield "".join(map(str, parts))
    elif isinstance(value, ast.Dict):
        for each in value.values:
            yield from texts(each)
    elif isinstance(value, ast.Call) and name(value.func) == "tuple":
        yield from texts(value.args[0])
    elif value is not None and not isinstance(value, ast.Call | ast.Subscript | ast.Compare):
        for child in ast.iter_child_nodes(value):
            yield from texts(child)


def is_sentence(text: str) -> bool:
    """Whether a text is a message, and not a name, a part of a message or code."""
    return "\n" not in text and sum(word.isalpha() for word in text.split()) >= MIN_WORDS


def name(node: ast.expr) -> str:
    """The last part of a dotted name."""
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""
