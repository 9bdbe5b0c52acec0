# SPDX-License-Identifier: GPL-3.0-or-later
"""The project's own facts: its files, and the packages it needs with their versions, from pyproject.toml."""

import subprocess
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
_DECLARED = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))

#: Names of groups to pip's requirements.
PACKAGES: dict[str, list[str]] = _DECLARED["dependency-groups"]
PIP: str = _DECLARED["tool"]["dev"]["pip"]
#: Python's version ("3.11") to the releases of bpy that are tested with it, the default first.
BPY: dict[str, list[str]] = _DECLARED["tool"]["dev"]["bpy"]
#: Blender's name of a platform to what its zip carries: python, tags, packages.
WHEELS: dict[str, dict[str, list[str]]] = _DECLARED["tool"]["dev"]["wheels"]


def files() -> list[str]:
    """Paths of all files that git does not ignore, from the root."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return [name for name in listed.split("\0") if (ROOT / name).is_file()]


def commit() -> str:
    """The commit that is checked out, with a + where files differ from it; empty where git cannot say."""
    command = ["git", "describe", "--always", "--abbrev=12", "--dirty=+"]
    try:
        return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return ""
