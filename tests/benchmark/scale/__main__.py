# SPDX-License-Identifier: GPL-3.0-or-later
"""Render time and memory as one parameter grows and the others are fixed: `dev.py bench scale`.

It writes scale.md and scale.json, and asserts nothing.
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
    parser.add_argument("--quick", action="store_true", help="a few values of each series: rough numbers")
    parser.add_argument("--only", help=f"some of {','.join(SERIES)}")
    options = parser.parse_args()
    names = options.only.split(",") if options.only else list(SERIES)
    if unknown := [name for name in names if name not in SERIES]:
        parser.error(f"no such series: {', '.join(unknown)}")
    options.output.mkdir(parents=True, exist_ok=True)
    results: dict[str, report.Results] = {}
    for name in names:
        series = SERIES[name]
        results[name] = {
            value: measure_in_process(name, value) for value in (series.quick if options.quick else series.values)
        }
        print(report.series(name, results[name]), flush=True)
    tables = [report.series(name, points) for name, points in results.items()]
    (options.output / "scale.md").write_text("\n\n".join([*tables, report.COUNTED]) + "\n", "utf-8")
    print(record.write(options.output, "scale", open_device().name, {"series": results}))
    return 0


def measure_in_process(name: str, value: int) -> dict:
    """Measure one picture in a new process, twice: the first process fills the driver's shader cache."""
    command = [sys.executable, "-m", "tests.benchmark.scale.point", name, str(value)]
    for _ in range(2):
        stdout = subprocess.check_output(command, cwd=project.ROOT, text=True, timeout=TIMEOUT)
    return json.loads(stdout.splitlines()[-1])


if __name__ == "__main__":
    sys.exit(main())
