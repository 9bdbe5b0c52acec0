# SPDX-License-Identifier: GPL-3.0-or-later
"""Facts of the project: its files and commit, and the versions of the packages it needs, from pyproject.toml."""

import subprocess
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
_DECLARED = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))

#: Names of dependency groups to pip's requirements.
PACKAGES: dict[str, list[str]] = _DECLARED["dependency-groups"]
PIP: str = _DECLARED["tool"]["dev"]["pip"]
#: Python's version ("3.11") to the releases of bpy that are tested with it, the default first.
BPY: dict[str, list[str]] = _DECLARED["tool"]["dev"]["bpy"]
#: Blender's name of a platform to the wheels of its zip: python, tags, packages.
WHEELS: dict[str, dict[str, list[str]]] = _DECLARED["tool"]["dev"]["wheels"]


def files() -> list[str]:
    """Paths of all files that git does not ignore, from the root."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return [name for name in listed.split("\0") if (ROOT / name).is_file()]


def commit() -> str:
    """The checked out commit, with a + if files differ from it; empty without git or a repository."""
    command = ["git", "describe", "--always", "--abbrev=12", "--dirty=+"]
    try:
        return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return ""
