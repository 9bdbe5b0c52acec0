# SPDX-License-Identifier: GPL-3.0-or-later
"""mypy knows what a frame holds under each resource's name."""

import re
import subprocess
import sys

import pytest

from tests.tools import project

#: What a pass may write, and what mypy must say of it: nothing where it is right.
SNIPPETS = {
    "width: int = frame[NORMAL].width": "",
    "width: int = frame[NORMAL]": r'expression has type "Texture"',
    "frame[NORMAL].columns": r'"Texture" has no attribute "columns"',
    "lights: int = frame[LIGHT_INFLUENCE]": r'variable has type "int"',
    "frame['normal']": r'Invalid index type "str" for "Frame"',
}


@pytest.fixture(scope="module")
def said(tmp_path_factory) -> dict[str, str]:
    """What mypy says of each snippet."""
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
def test_a_frame_is_typed(said, snippet):
    expected = SNIPPETS[snippet]
    assert bool(said[snippet]) == bool(expected)
    assert re.search(expected, said[snippet]), said[snippet]
