# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables and plots of docs/benchmarks.md and the README, made from docs/records."""

from collections.abc import Callable
from statistics import median
from typing import Any

from tests.benchmark.error import report as error_report
from tests.benchmark.error.race import Result
from tests.benchmark.error.record import result_of
from tests.benchmark.scale import report as scale_report
from tests.benchmark.scale.series import SERIES

from . import plot, record

OURS = "ISM"
#: Curves of the scale plot: columns of its table that are times, and how many seconds their unit has.
TIMES = {"first sync s": 1.0, "shadows ms": 1e-3, "first sample s": 1.0, "further sample s": 1.0}


def races() -> dict[str, Result]:
    """Of each scene: every engine's errors after so many seconds."""
    return {name: result_of(told) for name, told in record.read("error")["scenes"].items()}


def race_table() -> str:
    """Seconds to the same error, and where they come from."""
    found = record.read("error")
    width, height = found["effort"]["size"]
    curves = {name: result.curves for name, result in races().items()}
    table = error_report.race_table(curves, OURS)
    return f"{table}\n\n{width}×{height} pixels. {record.sentence(found)}"


def error_tables() -> str:
    """Errors after a time, of all scenes."""
    curves = {name: result.curves for name, result in races().items()}
    return "\n\n".join(error_report.budget_table(curves, OURS, measure) for measure in error_report.NAMES)


def error_per_sample() -> str:
    """RMSE/mean of each scene after so many samples, which is the same on any machine."""
    counts = (1, 4, 16, 64, 256)
    rows = [["scene", "triangles", "lights", *(f"{count} samples" for count in counts)]]
    for name, result in races().items():
        errors = {point.samples: error_report.number(point.error.rmse) for point in result.curves[OURS]}
        size = f"{result.facts['triangles']:,}", f"{result.facts['lights']}"
        rows.append([name, *size, *(errors.get(count, "–") for count in counts)])
    return error_report.table(rows)


def error_plot() -> str:
    """Error against time, a panel for each scene."""
    panels = []
    for name, result in races().items():
        curves = {
            engine: [(point.seconds, point.error.rmse) for point in points if point.error.rmse > 0.0]
            for engine, points in result.curves.items()
        }
        panels.append(plot.Panel(name, "seconds", "RMSE / mean", curves))
    return plot.svg(panels, columns=3)


def scale_tables() -> str:
    """Time and memory as one thing grows."""
    found = record.read("scale")
    series = [scale_report.series(name, by_value(points)) for name, points in found["series"].items()]
    tables = [table.replace("## ", "**", 1).replace("\n", "**\n", 1) for table in series]
    return "\n\n".join([record.sentence(found), *tables, scale_report.COUNTED])


def scale_plot() -> str:
    """The same as curves."""
    panels = []
    for name, points in record.read("scale")["series"].items():
        curves = {}
        for heading, unit in TIMES.items():
            found = [(value, unit * scale_report.COLUMNS[heading](told)) for value, told in by_value(points).items()]
            curves[heading.rsplit(" ", 1)[0]] = [(value, seconds) for value, seconds in found if seconds > 0.0]
        panels.append(plot.Panel(name.replace("_", " "), SERIES[name].unit, "seconds", curves))
    return plot.svg(panels, columns=2)


def by_value(points: dict[str, Any]) -> dict[int, Any]:
    """A series as scale.report knows it: JSON's keys are text."""
    return {int(value): told for value, told in points.items()}


def shortcuts_table() -> str:
    """What is saved by leaving out work that changes no picture."""
    found = record.read("skip")
    rows = [["case", "ms", "nothing left out, ms", "faster", "RMSE/mean between them", "lights used"]]
    for name, each in found["cases"].items():
        times = error_report.number(each["ms"]), error_report.number(each["no skip"]), f"{each['faster']:.1f}×"
        rows.append([name, *times, f"{each['apart']:.4f}", f"{each['lights_used']:,}"])
    return f"{error_report.table(rows)}\n\n{record.sentence(found)}"


def atrium_table() -> str:
    """Whole renders."""
    found = record.read("atrium")
    rows = [["engine", "seconds, median", "least", "most"]]
    for name, times in found["seconds"].items():
        rows.append([name, *(f"{value:.2f}" for value in (median(times), min(times), max(times)))])
    return f"{error_report.table(rows)}\n\n{found['size'].replace('x', '×')} pixels. {record.sentence(found)}"


#: What stands between markers of this name, and files that are generated as a whole, from the root.
PARTS: dict[str, Callable[[], str]] = {
    "race": race_table,
    "error after a time": error_tables,
    "error after samples": error_per_sample,
    "scale": scale_tables,
    "shortcuts": shortcuts_table,
    "atrium": atrium_table,
}
PLOTS: dict[str, Callable[[], str]] = {"docs/pictures/error.svg": error_plot, "docs/pictures/scale.svg": scale_plot}
