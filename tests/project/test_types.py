# SPDX-License-Identifier: GPL-3.0-or-later
"""mypy knows the type of each resource of a frame."""

import re
import subprocess
import sys

import pytest

from tests.tools import project

#: Statements of a pass, and the error that mypy must report; empty for correct ones.
SNIPPETS = {
    "width: int = frame[NORMAL].width": "",
    "width: int = frame[NORMAL]": r'expression has type "Texture"',
    "frame[NORMAL].columns": r'"Texture" has no attribute "columns"',
    "lights: int = frame[LIGHT_INFLUENCE]": r'variable has type "int"',
    "frame['normal']": r'Invalid index type "str" for "Frame"',
}


@pytest.fixture(scope="module")
def mypy_errors(tmp_path_factory) -> dict[str, str]:
    """mypy's errors for each snippet."""
    imports = "from ism_addon.gpu.frame import Frame\nfrom ism_addon.resources import LIGHT_INFLUENCE, NORMAL\n"
    bodies = "".join(f"def body_{k}(frame: Frame) -> None: {snippet}\n" for k, snippet in enumerate(SNIPPETS))
    path = tmp_path_factory.mktemp("types") / "snippets.py"
    path.write_text(imports + bodies)
    run = subprocess.run(
        [sys.executable, "-m", "mypy", "--no-error-summary", path], cwd=project.ROOT, capture_output=True, text=True
    )
    lines = [line for line in run.stdout.splitlines() if path.name in line]
    first = imports.count("\n") + 1
    return {
        snippet: "\n".join(line for line in lines if f":{first + k}: error" in line)
        for k, snippet in enumerate(SNIPPETS)
    }


@pytest.mark.parametrize("snippet", SNIPPETS)
def test_a_frame_is_typed(mypy_errors, snippet):
    expected = SNIPPETS[snippet]
    assert bool(mypy_errors[snippet]) == bool(expected)
    assert re.search(expected, mypy_errors[snippet]), mypy_errors[snippet]
