# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables and plots of docs/benchmarks.md and the README, made from docs/records."""

import math
from collections.abc import Callable
from statistics import median
from typing import Any

from tests.benchmark.error import report as error_report
from tests.benchmark.error.curve import error_at
from tests.benchmark.error.measure import Result
from tests.benchmark.error.record import result_of
from tests.benchmark.scale import report as scale_report
from tests.benchmark.scale.series import SERIES

from . import plot, record

OURS = "ISM"
#: Numbers of samples whose error is told.
SAMPLES = (1, 4, 16, 64, 256)
#: ms. Parts of a render that take less are not told.
LEAST_MS = 1.0
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


def error_after_time() -> str:
    """Ours and, in brackets, the better of Cycles with and without OpenImageDenoise, as long as there are pictures."""
    tables = []
    for measure, title in error_report.NAMES.items():
        rows = [["scene", *(f"{budget:g} s" for budget in error_report.BUDGETS)]]
        for name, result in races().items():
            least = result.facts["resolution of the error"] if measure == "rmse" else 0.0
            pairs = (errors_at(result, budget, measure) for budget in error_report.BUDGETS)
            rows.append([name, *(f"{known(ours, least)} ({known(theirs, least)})" for ours, theirs in pairs)])
        tables.append(f"{title}:\n\n{error_report.table(rows)}")
    return "\n\n".join(tables)


def errors_at(result: Result, seconds: float, measure: str) -> tuple[float, float]:
    """Ours and the better rival's after some seconds; infinite before the first and after the last picture."""
    found = {
        name: error_at(points, seconds, measure) if seconds <= points[-1].seconds else math.inf
        for name, points in result.curves.items()
    }
    return found[OURS], min(found[name] for name in error_report.RIVALS)


def known(error: float, least: float) -> str:
    """An error; what is below the least that the truth's noise lets be told is below that."""
    return f"< {error_report.number(least)}" if error < least else error_report.number(error)


def error_per_sample() -> str:
    """RMSE/mean of each scene after so many samples, which is the same on any machine."""
    rows = [["scene", "triangles", "lights", *(f"after {count}" for count in SAMPLES)]]
    for name, result in races().items():
        least = result.facts["resolution of the error"]
        errors = {point.samples: known(point.error.rmse, least) for point in result.curves[OURS]}
        size = f"{result.facts['triangles']:,}", f"{result.facts['lights']}"
        rows.append([name, *size, *(errors.get(count, "–") for count in SAMPLES)])
    return error_report.table(rows)


def error_plot() -> str:
    """Error against time, a panel for each scene, as far as the truth's noise lets it be told."""
    panels = []
    for name, result in races().items():
        least = result.facts["resolution of the error"]
        curves = {
            engine: [(point.seconds, point.error.rmse) for point in points if point.error.rmse > least]
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


def small_meshes_table() -> str:
    """The parts of a render that take longest, and Cycles' whole render, in turns."""
    found = record.read("small_meshes")
    _, *rounds = found["rounds"]  # the first loads programs and compiles shaders
    medians = {part: median(each[part] for each in rounds) for part in rounds[0]}
    names = {"whole": "our whole render", "read": "reading the scene", "Cycles": "Cycles' whole render"}
    rows = [["part", "ms"]]
    rows += [[names.get(part, part), f"{ms:.0f}"] for part, ms in medians.items() if ms >= LEAST_MS]
    return f"{error_report.table(rows)}\n\n{found['meshes']:,} meshes. {record.sentence(found)}"


def pass_table() -> str:
    """Milliseconds of each pass in the middle one of the atrium's renders."""
    found = record.read("atrium")
    profile = sorted(found["profiles"], key=lambda each: each["seconds"])[len(found["profiles"]) // 2]
    rows = [["pass", "ms"]]
    rows += [[name, f"{row['ms']:.1f}"] for name, row in profile["passes"].items() if row["drawn"]]
    return f"{error_report.table(rows)}\n\n{found['size'].replace('x', '×')} pixels. {record.sentence(found)}"


def constants_table() -> str:
    """What tuned constants cost at half and at twice their value."""
    found = record.read("constants")
    tables = []
    for about, group in found["groups"].items():
        rows = [["constant", "value", "half", "double"]]
        for name, each in group["constants"].items():
            rows.append([f"`{name}`", f"{each['value']:g}", f"{each['half']:.2f}", f"{each['double']:.2f}"])
        tables.append(f"Of {about} ({', '.join(group['scenes'])}):\n\n{error_report.table(rows)}")
    width, height = found["size"]
    return "\n\n".join([*tables, f"{width}×{height} pixels. {record.sentence(found)}"])


def draws_table() -> str:
    """How long the largest draw of each pass takes, in the kinds of images that have it."""
    found = record.read("draws")
    images = found["seconds"]
    rows = [["pass", *images]]
    for name in dict.fromkeys(name for passes in images.values() for name in passes):
        times = (passes.get(name) for passes in images.values())
        rows.append([f"`{name}`", *(f"{median(each):.2f}" if each else "" for each in times)])
    size, sentence = found["size"].replace("x", "×"), record.sentence(found)
    return f"{error_report.table(rows)}\n\nSeconds; {found['scene']}, {size} pixels. {sentence}"


#: What stands between markers of this name, and files that are generated as a whole, from the root.
PARTS: dict[str, Callable[[], str]] = {
    "race": race_table,
    "error after a time": error_after_time,
    "error after samples": error_per_sample,
    "scale": scale_tables,
    "shortcuts": shortcuts_table,
    "atrium": atrium_table,
    "passes": pass_table,
    "small meshes": small_meshes_table,
    "constants": constants_table,
    "draws": draws_table,
}
PLOTS: dict[str, Callable[[], str]] = {"docs/pictures/error.svg": error_plot, "docs/pictures/scale.svg": scale_plot}
