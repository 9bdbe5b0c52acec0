# SPDX-License-Identifier: GPL-3.0-or-later
"""Every sentence that a user can meet, found in the code: what is raised, reported, noted about a scene or printed.

What a sentence quotes, such as a name or a number, stands in it as "…".
"""

import ast
from collections.abc import Iterator

from tests.tools import project

ADDON = project.ROOT / "ism_addon"

#: Calls that show a user their argument of this number, or their keyword of this name. Names of functions are enough.
CALLS: dict[str, int | str] = {"warn": 0, "report": 1, "end": 1, "notify": "error", "label": "text"}
#: Names that hold nothing but sentences or kinds of trouble. A tuple's or dictionary's texts are sentences too.
NAMES = {"issue", "kind", "why", "sentence", "GLOSS", "PLAIN"}
#: Words that make a text a sentence, rather than a name or a part of one.
FEWEST_WORDS = 3
#: Exceptions that no user can meet: a programmer's mistake, or what is caught where it is raised.
INNER = {"NotImplementedError", "_Cancelled", "Cancelled", "KeyError", "TypeError"}


def sentences() -> dict[str, str]:
    """Each sentence, and the module that it stands in."""
    found: dict[str, str] = {}
    for path in sorted(ADDON.rglob("*.py")):
        module = path.relative_to(ADDON).with_suffix("").as_posix()
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            for value in shown(node):
                found |= {text: module for text in texts(value) if is_sentence(text)}
    return found


def shown(node: ast.AST) -> Iterator[ast.expr | None]:
    """What of a statement or call is shown to users."""
    if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and name(node.exc.func) not in INNER:
        yield from node.exc.args[:1]
    elif isinstance(node, ast.Call):
        place = CALLS.get(name(node.func))
        if isinstance(place, int):
            yield from node.args[place : place + 1]
        elif place:
            yield from (keyword.value for keyword in node.keywords if keyword.arg == place)
    elif isinstance(node, ast.Return | ast.Yield) or NAMES & set(map(name, assigned(node))):
        yield node.value


def assigned(node: ast.AST) -> list[ast.expr]:
    """What a statement gives a value."""
    if isinstance(node, ast.AnnAssign | ast.AugAssign):
        return [node.target]
    return node.targets if isinstance(node, ast.Assign) else []


def texts(value: ast.AST | None) -> Iterator[str]:
    """Texts in an expression, as sentences show them."""
    if isinstance(value, ast.Constant) and isinstance(value.value, str):
        yield value.value
    elif isinstance(value, ast.JoinedStr):
        parts = (part.value if isinstance(part, ast.Constant) else "…" for part in value.values)
        yield "".join(map(str, parts))
    elif isinstance(value, ast.Call) and name(value.func) == "tuple":
        yield from texts(value.args[0])
    elif value is not None and not isinstance(value, ast.Call | ast.Subscript | ast.Compare):
        for child in ast.iter_child_nodes(value):
            yield from texts(child)


def is_sentence(text: str) -> bool:
    """Whether a text says something, rather than being a name, a part or code."""
    return "\n" not in text and sum(word.isalpha() for word in text.split()) >= FEWEST_WORDS


def name(node: ast.expr) -> str:
    """The last part of a dotted name."""
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""
