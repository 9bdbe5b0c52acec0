# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of scenarios, read from their source: the scenarios themselves can be imported only in Blender."""

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
    timeout: int = 120  # s, for all of the scenario
    any_size: bool = True  # whether the region may be smaller with --any-pace
    alone: bool = False  # whether it needs a Blender of its own: it measures memory, changes preferences or leaves jobs


def scenario(**_fields: object) -> Callable[[Callable], Callable]:
    """Mark a function as a scenario. `scenarios` reads the arguments, literals for fields of Scenario."""
    return lambda function: function


def scenarios() -> list[Scenario]:
    """All scenarios, by file and line."""
    found = []
    for path in sorted(FOLDER.glob("[!_]*.py")):
        for node in ast.parse(path.read_text("utf-8")).body:
            if isinstance(node, ast.FunctionDef) and (fields := _fields(node)) is not None:
                about = (ast.get_docstring(node) or "").partition("\n")[0]
                found.append(Scenario(path.stem, node.name, about, **fields))
    return found


def _fields(node: ast.FunctionDef) -> dict | None:
    """The arguments of the `scenario` decorator; None without one."""
    for decorator in node.decorator_list:
        if isinstance(decorator, ast.Call) and ast.unparse(decorator.func) == "scenario":
            return {keyword.arg: ast.literal_eval(keyword.value) for keyword in decorator.keywords}
    return None
