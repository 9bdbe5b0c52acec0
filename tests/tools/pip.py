# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs pip with short output: a line for each large download, with its progress if the output is a terminal."""

import os
import re
import subprocess
import sys
import sysconfig
from pathlib import Path

from . import project

LARGE_DOWNLOAD = re.compile(r"Downloading (\S+) \(([\d.]+ [MG]B)\)")
WHEEL_TAGS = re.compile(r"-(cp|py)\d.*")
PROGRESS = re.compile(r"Progress (\d+) of (\d+)")


def install_pinned(python: Path) -> None:
    """Install the pip for that interpreter whose output `run` can parse. It needs no pip yet.

    It is installed by the one that Python has for new environments, from its wheel: to unpack that first takes as long.
    """
    arguments = "--disable-pip-version-check", "install", "--no-compile", f"pip=={project.PIP}"
    environment = {**os.environ, "PYTHONPATH": str(bundled_wheel())}
    done = subprocess.run([python, "-m", "pip", *arguments], capture_output=True, text=True, env=environment)
    if done.returncode:
        sys.exit(f"pip {project.PIP} could not be installed:\n{done.stderr}")


def bundled_wheel() -> Path:
    """The wheel of the pip that Python has for new environments. Exits if there is none."""
    import ensurepip  # Debian has it in a package of its own, which dev.py installs if it is missing

    folders = [Path(ensurepip.__file__).with_name("_bundled"), Path(sysconfig.get_config_var("WHEEL_PKG_DIR") or ".")]
    wheels = [wheel for folder in folders for wheel in folder.glob("pip-*.whl")]
    return wheels[0] if wheels else sys.exit("Python's own pip is missing: its package ensurepip has no wheel of it.")


def install(python: Path, *arguments: str) -> None:
    """`pip install arguments`, which leaves bytecode to those modules that are imported: few of the thousands."""
    run(python, "install", "--no-compile", *arguments)


def run(python: Path, command: str, *arguments: str) -> None:
    """Run `pip command arguments` of that interpreter. If it fails, exits with pip's error messages."""
    pip = subprocess.Popen(
        [python, "-m", "pip", "--disable-pip-version-check", command, "--progress-bar=raw", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert pip.stdout is not None
    errors = []
    for line in pip.stdout:
        _show(line)
        if line.startswith("ERROR"):
            errors.append(line)
    if pip.wait():
        sys.exit(f"pip {command} failed.\n{''.join(errors)}")


def _show(line: str) -> None:
    if download := LARGE_DOWNLOAD.search(line):
        print(f"  downloading {WHEEL_TAGS.sub('', download[1])} ({download[2]})", flush=True)
    elif line.startswith("Installing collected packages:"):
        print("  unpacking", flush=True)
    elif sys.stdout.isatty() and (progress := PROGRESS.match(line)):
        done, total = map(int, progress.groups())
        print(f"  {done / total:4.0%}", end="\r", flush=True)
