# SPDX-License-Identifier: GPL-3.0-or-later
"""Time and memory as one thing grows, the rest fixed: `dev.py bench scale`.

Out come scale.md and scale.json. It reports; it judges nothing.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

from ism_addon.gpu.gl.context import open_device
from tests.docs import record
from tests.tools import project

from . import report
from .series import SERIES

TIMEOUT = 1800  # s, for one picture


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.scale", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record and the tables")
    parser.add_argument("--quick", action="store_true", help="a few values of each: a rough look")
    parser.add_argument("--only", help=f"some of {','.join(SERIES)}")
    options = parser.parse_args()
    names = options.only.split(",") if options.only else list(SERIES)
    if unknown := [name for name in names if name not in SERIES]:
        parser.error(f"nothing grows by the name {', '.join(unknown)}")
    options.output.mkdir(parents=True, exist_ok=True)
    results: dict[str, report.Results] = {}
    for name in names:
        series = SERIES[name]
        results[name] = {value: measured(name, value) for value in (series.quick if options.quick else series.values)}
        print(report.series(name, results[name]), flush=True)
    tables = [report.series(name, points) for name, points in results.items()]
    (options.output / "scale.md").write_text("\n\n".join([*tables, report.COUNTED]) + "\n", "utf-8")
    print(record.write(options.output, "scale", open_device().name, {"series": results}))
    return 0


def measured(name: str, value: int) -> dict:
    """What one picture took, in a process of its own; one before it has filled the driver's cache of shaders."""
    command = [sys.executable, "-m", "tests.benchmark.scale.point", name, str(value)]
    for _ in range(2):
        said = subprocess.check_output(command, cwd=project.ROOT, text=True, timeout=TIMEOUT)
    return json.loads(said.splitlines()[-1])


if __name__ == "__main__":
    sys.exit(main())
