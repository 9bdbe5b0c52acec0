# SPDX-License-Identifier: GPL-3.0-or-later
"""A benchmark's record: what was measured and on what, when and by which command, as JSON.

`python3 dev.py docs NAME` copies the record to docs/records and writes the tables and plots of the documentation anew.
"""

import json
import math
import os
import platform
import shlex
import sys
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

import bpy

from tests.tools import project

PACKAGES = ("numpy", "moderngl")
#: Processes that wanted a core in the minute before this one began, on average. It is 0 on a quiet machine.
LOAD_BEFORE = os.getloadavg()[0] if hasattr(os, "getloadavg") else None


def write(folder: Path, name: str, opengl: str, measured: Mapping[str, object]) -> Path:
    """Write NAME.json: `measured` after what it was measured on. `opengl` is the driver's name."""
    path = folder / f"{name}.json"
    content = origin(name, opengl) | finite(dict(measured))
    path.write_text(json.dumps(content, indent=1, allow_nan=False), "utf-8")
    return path


def finite(value: Any) -> Any:
    """A value with null for numbers that JSON has not: such as an error that nobody knows yet."""
    if isinstance(value, Mapping):
        return {name: finite(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def origin(name: str, opengl: str) -> dict[str, object]:
    """When, by which command, of which commit, and on what."""
    return {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "command": shlex.join(["python3", "dev.py", "bench", name, *without_output(sys.argv[1:])]),
        "commit": project.commit(),
        "machine": {
            "system": platform.system(),
            "processor": processor(),
            "cores": os.cpu_count(),
            "opengl": opengl,
            "load before": LOAD_BEFORE,
        },
        "versions": {"blender": bpy.app.version_string} | {name: metadata.version(name) for name in PACKAGES},
    }


def without_output(arguments: list[str]) -> list[str]:
    """A benchmark's arguments without the folder of its record."""
    if "--output" not in arguments:
        return arguments
    at = arguments.index("--output")
    return arguments[:at] + arguments[at + 2 :]


def processor() -> str:
    """Its model."""
    path = Path("/proc/cpuinfo")
    lines = path.read_text("utf-8").splitlines() if path.exists() else []
    models = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(models, platform.processor() or platform.machine())


#: Records that the documentation is made from.
FOLDER = project.ROOT / "docs" / "records"


def read(name: str) -> dict[str, Any]:
    """The record that docs/records has of a benchmark."""
    return json.loads((FOLDER / f"{name}.json").read_text("utf-8"))


def keep(path: Path) -> None:
    """Let a record that a benchmark has just written take the place of the one in docs/records."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    (FOLDER / path.name).write_bytes(path.read_bytes())


def sentence(record: Mapping[str, Any]) -> str:
    """Where the numbers come from."""
    machine, versions = record["machine"], record["versions"]
    load = machine["load before"]
    busy = "" if load is None else f"; {load:.1f} other processes were running when it began"
    return (
        f"Recorded {record['date'][:10]} by `{record['command']}`, commit {record['commit']}: {machine['cores']} cores "
        f"of {machine['processor']}, {machine['opengl']}, {machine['system']}, Blender {versions['blender']}{busy}."
    )
