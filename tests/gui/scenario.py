# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scenario is, and which there are: known without Blender, which the scenarios themselves need."""

import ast
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

FOLDER = Path(__file__).with_name("scenarios")


@dataclass(frozen=True)
class Scenario:
    """A generator function `name(session)` in a module of `scenarios`."""

    module: str
    name: str
    about: str
    region: tuple[int, int] | None = None  # pixels of the 3D viewport, in Blender's factory layout; None: any
    patience: int = 120  # s, for all of it


def scenario(**_facts: object) -> Callable[[Callable], Callable]:
    """Mark a function as a scenario. The facts, literals for fields of Scenario, are read by `scenarios`."""
    return lambda function: function


def scenarios() -> list[Scenario]:
    """All there are, by file and place in it."""
    found = []
    for path in sorted(FOLDER.glob("[!_]*.py")):
        for node in ast.parse(path.read_text("utf-8")).body:
            if isinstance(node, ast.FunctionDef) and (facts := _facts(node)) is not None:
                about = (ast.get_docstring(node) or "").partition("\n")[0]
                found.append(Scenario(path.stem, node.name, about, **facts))
    return found


def _facts(node: ast.FunctionDef) -> dict | None:
    for mark in node.decorator_list:
        if isinstance(mark, ast.Call) and ast.unparse(mark.func) == "scenario":
            return {keyword.arg: ast.literal_eval(keyword.value) for keyword in mark.keywords}
    return None
