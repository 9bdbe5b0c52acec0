# SPDX-License-Identifier: GPL-3.0-or-later
"""A benchmark's record as JSON: the results, the machine, the date and the command.

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

from tests.tools import project

PACKAGES = ("numpy", "moderngl")
#: Runnable processes in the minute before this one began, on average. It is 0 on an idle machine.
LOAD_BEFORE = os.getloadavg()[0] if hasattr(os, "getloadavg") else None


def write(folder: Path, name: str, opengl: str, measured: Mapping[str, object]) -> Path:
    """Write NAME.json: its origin, and what was measured. `opengl` is the driver's name."""
    path = folder / f"{name}.json"
    content = origin(name, opengl) | finite(dict(measured))
    path.write_text(json.dumps(content, indent=1, allow_nan=False), "utf-8")
    return path


def finite(value: Any) -> Any:
    """A value in which numbers that are not finite are None: JSON does not have them."""
    if isinstance(value, Mapping):
        return {name: finite(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def origin(name: str, opengl: str) -> dict[str, object]:
    """The date, the command, the commit, the machine and the versions."""
    return {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "command": shlex.join(["python3", "dev.py", "bench", name, *arguments(sys.argv[1:])]),
        "commit": project.commit(),
        "machine": {
            "system": platform.system(),
            "processor": processor(),
            "cores": os.cpu_count(),
            "opengl": opengl,
            "load before": LOAD_BEFORE,
        },
        "versions": blender_version() | {name: metadata.version(name) for name in PACKAGES},
    }


def blender_version() -> dict[str, str]:
    """Of the Blender that the benchmark uses; empty if it uses none."""
    return {"blender": sys.modules["bpy"].app.version_string} if "bpy" in sys.modules else {}


def arguments(given: list[str]) -> list[str]:
    """A benchmark's arguments, files by their names alone, without the folder of its record."""
    if "--output" in given:
        index = given.index("--output")
        given = given[:index] + given[index + 2 :]
    return [Path(each).name if Path(each).is_file() else each for each in given]


def processor() -> str:
    """The model of the CPU."""
    path = Path("/proc/cpuinfo")
    lines = path.read_text("utf-8").splitlines() if path.exists() else []
    models = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(models, platform.processor() or platform.machine())


#: Folder of the records that the documentation is made from.
FOLDER = project.ROOT / "docs" / "records"


def read(name: str) -> dict[str, Any]:
    """The record of a benchmark in docs/records."""
    return json.loads((FOLDER / f"{name}.json").read_text("utf-8"))


def keep(path: Path) -> None:
    """Copy a new record to docs/records, where it replaces the old one."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    (FOLDER / path.name).write_bytes(path.read_bytes())


def sentence(record: Mapping[str, Any]) -> str:
    """A sentence on the origin of a record's numbers."""
    machine, versions = record["machine"], record["versions"]
    load = machine["load before"]
    blender = f", Blender {versions['blender']}" if "blender" in versions else ""
    busy = "" if load is None else f"; {load:.1f} other processes were running when it began"
    return (
        f"Recorded {record['date'][:10]} by `{record['command']}`, commit {record['commit']}: {machine['cores']} cores "
        f"of {machine['processor']}, {machine['opengl']}, {machine['system']}{blender}{busy}."
    )
