# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables and plots of docs/benchmarks.md and the README, made from docs/records."""

import math
from collections.abc import Callable
from statistics import median
from typing import Any

from ism_addon.choices import OcclusionSampling
from tests.benchmark.error import report as error_report
from tests.benchmark.error.curve import error_at
from tests.benchmark.error.measure import Result
from tests.benchmark.error.record import result_from_json
from tests.benchmark.scale import report as scale_report
from tests.benchmark.scale.series import SERIES

from . import plot, record

OURS = "ISM"
#: Numbers of samples whose error is in the table.
SAMPLES = (1, 4, 16, 64, 256)
#: Parts of a render that take less are not in the table.
MIN_MS = 1.0
#: Curves of the scale plot: columns of its table that are times, and their unit in seconds.
TIMES = {"first sync s": 1.0, "shadows ms": 1e-3, "first sample s": 1.0, "further sample s": 1.0}


def error_results() -> dict[str, Result]:
    """Results of the error benchmark, by scene."""
    return {name: result_from_json(scene) for name, scene in record.read("error")["scenes"].items()}


def goal_table() -> str:
    """Seconds to the same error, and their origin."""
    recorded = record.read("error")
    width, height = recorded["effort"]["size"]
    curves = {name: result.curves for name, result in error_results().items()}
    table = error_report.goal_table(curves, OURS)
    return f"{table}\n\n{width}×{height} pixels. {record.sentence(recorded)}"


def error_after_time() -> str:
    """Our errors after some times and, in brackets, the lower one of Cycles with and without OpenImageDenoise."""
    tables = []
    for measure, title in error_report.NAMES.items():
        rows = [["scene", *(f"{budget:g} s" for budget in error_report.BUDGETS)]]
        for name, result in error_results().items():
            min_error = result.facts["resolution of the error"] if measure == "rmse" else 0.0
            pairs = (errors_at(result, budget, measure) for budget in error_report.BUDGETS)
            rows.append(
                [name, *(f"{error_text(ours, min_error)} ({error_text(theirs, min_error)})" for ours, theirs in pairs)]
            )
        tables.append(f"{title}:\n\n{error_report.table(rows)}")
    return "\n\n".join(tables)


def errors_at(result: Result, seconds: float, measure: str) -> tuple[float, float]:
    """Our error and the lower one of Cycles after some seconds; infinite before the first and after the last render."""
    errors = {
        name: error_at(points, seconds, measure) if seconds <= points[-1].seconds else math.inf
        for name, points in result.curves.items()
    }
    return errors[OURS], min(errors[name] for name in error_report.BASELINES)


def error_text(error: float, min_error: float) -> str:
    """An error, or that it is below the least error that the reference's noise lets be measured."""
    return f"< {error_report.format_number(min_error)}" if error < min_error else error_report.format_number(error)


def error_per_sample() -> str:
    """RMSE/mean of each scene by number of samples, which does not depend on the machine's speed."""
    rows = [["scene", "triangles", "lights", *(f"after {count}" for count in SAMPLES)]]
    for name, result in error_results().items():
        min_error = result.facts["resolution of the error"]
        errors = {point.samples: error_text(point.error.rmse, min_error) for point in result.curves[OURS]}
        size = f"{result.facts['triangles']:,}", f"{result.facts['lights']}"
        rows.append([name, *size, *(errors.get(count, "–") for count in SAMPLES)])
    return error_report.table(rows)


def error_plot() -> str:
    """Error against time, a panel for each scene. Errors below the reference's noise are left out."""
    panels = []
    for name, result in error_results().items():
        min_error = result.facts["resolution of the error"]
        curves = {
            engine: [(point.seconds, point.error.rmse) for point in points if point.error.rmse > min_error]
            for engine, points in result.curves.items()
        }
        panels.append(plot.Panel(name, "seconds", "RMSE / mean", curves))
    return plot.svg(panels, columns=3)


def scale_tables() -> str:
    """Render time and memory by each parameter that grows."""
    recorded = record.read("scale")
    series = [scale_report.series(name, by_value(points)) for name, points in recorded["series"].items()]
    tables = [table.replace("## ", "**", 1).replace("\n", "**\n", 1) for table in series]
    return "\n\n".join([record.sentence(recorded), *tables, scale_report.COUNTED])


def scale_plot() -> str:
    """Render times by each parameter that grows, a panel for each."""
    panels = []
    for name, points in record.read("scale")["series"].items():
        curves = {}
        for heading, unit in TIMES.items():
            times = [(value, unit * scale_report.COLUMNS[heading](point)) for value, point in by_value(points).items()]
            curves[heading.rsplit(" ", 1)[0]] = [(value, seconds) for value, seconds in times if seconds > 0.0]
        panels.append(plot.Panel(name.replace("_", " "), SERIES[name].unit, "seconds", curves))
    return plot.svg(panels, columns=2)


def by_value(points: dict[str, Any]) -> dict[int, Any]:
    """A series with integers as keys, as scale.report expects; JSON's keys are strings."""
    return {int(value): point for value, point in points.items()}


def shortcuts_table() -> str:
    """Time saved by skipping work that changes no picture."""
    recorded = record.read("skip")
    rows = [["case", "ms", "nothing left out, ms", "faster", "RMSE/mean between them", "lights used"]]
    for name, each in recorded["cases"].items():
        times = (
            error_report.format_number(each["ms"]),
            error_report.format_number(each["no skip"]),
            f"{each['faster']:.1f}×",
        )
        rows.append([name, *times, f"{each['apart']:.4f}", f"{each['lights_used']:,}"])
    return f"{error_report.table(rows)}\n\n{record.sentence(recorded)}"


def atrium_table() -> str:
    """Times of whole renders by each engine."""
    recorded = record.read("atrium")
    rows = [["engine", "seconds, median", "least", "most"]]
    for name, times in recorded["seconds"].items():
        rows.append([name, *(f"{value:.2f}" for value in (median(times), min(times), max(times)))])
    return f"{error_report.table(rows)}\n\n{recorded['size'].replace('x', '×')} pixels. {record.sentence(recorded)}"


def small_meshes_table() -> str:
    """The parts of our render that take longest, our whole render and Cycles'."""
    recorded = record.read("small_meshes")
    _, *rounds = recorded["rounds"]  # the first one loads programs and compiles shaders
    medians = {part: median(each[part] for each in rounds) for part in rounds[0]}
    names = {"whole": "our whole render", "read": "reading the scene", "Cycles": "Cycles' whole render"}
    rows = [["part", "ms"]]
    rows += [[names.get(part, part), f"{ms:.0f}"] for part, ms in medians.items() if ms >= MIN_MS]
    return f"{error_report.table(rows)}\n\n{recorded['meshes']:,} meshes. {record.sentence(recorded)}"


def image_memory_table() -> str:
    """Memory of Blender and of our render, by images."""
    recorded = record.read("image_memory")
    rows = [["images", "file open", "images decoded", "render", "above file open", "above images decoded"]]
    for each in recorded["results"]:
        count, side, file_format = each["images"].values()
        name = f"{count} of {side}² px, {file_format.replace('_', '')}" if count else "none"
        opened, decoded, peak = (each[part] / 1e9 for part in ("file open", "images decoded", "peak"))
        rows.append([name, *(f"{value:.2f}" for value in (opened, decoded, peak, peak - opened, peak - decoded))])
    return f"{error_report.table(rows)}\n\nGB. {record.sentence(recorded)}"


def large_map_table() -> str:
    """Seconds until a large map lights a scene."""
    recorded = record.read("large_map")
    rounds = recorded["rounds"]
    rows = [["seconds, median (least to most)", *rounds]]
    for part in next(iter(rounds.values()))[0]:
        by_condition = [[each[part] for each in measured] for measured in rounds.values()]
        rows.append([part, *(f"{median(each):.2f} ({min(each):.2f} to {max(each):.2f})" for each in by_condition)])
    width = recorded["width"]
    return f"{error_report.table(rows)}\n\n{width}×{width // 2} pixels, OpenEXR. {record.sentence(recorded)}"


def pass_table() -> str:
    """Milliseconds of each pass in the atrium's render of median time."""
    recorded = record.read("atrium")
    profile = sorted(recorded["profiles"], key=lambda each: each["seconds"])[len(recorded["profiles"]) // 2]
    rows = [["pass", "ms"]]
    rows += [[name, f"{row['ms']:.1f}"] for name, row in profile["passes"].items() if row["drawn"]]
    return f"{error_report.table(rows)}\n\n{recorded['size'].replace('x', '×')} pixels. {record.sentence(recorded)}"


def gpu_table() -> str:
    """Frames per second on a graphics card, by scene, method and case."""
    recorded = record.read("gpu")
    rows = [["scene", "triangles", "method", "pixels", "frames/s", "ms a frame, median"]]
    for each in recorded["cases"]:
        names = each["scene"], f"{each['triangles']:,}", each["method"], each["case"]
        rows.append([*names, f"{each['frames a second']:.1f}", f"{each['ms']:.1f}"])
    return f"{error_report.table(rows)}\n\n{record.sentence(recorded)}"


def constants_table() -> str:
    """The relative cost of tuned constants at half and at twice their value."""
    recorded = record.read("constants")
    tables = []
    for about, group in recorded["groups"].items():
        rows = [["constant", "value", "half", "double"]]
        for name, each in group["constants"].items():
            rows.append([f"`{name}`", f"{each['value']:g}", f"{each['half']:.2f}", f"{each['double']:.2f}"])
        tables.append(f"Of {about} ({', '.join(group['scenes'])}):\n\n{error_report.table(rows)}")
    width, height = recorded["size"]
    return "\n\n".join([*tables, f"{width}×{height} pixels. {record.sentence(recorded)}"])


def draws_table() -> str:
    """Seconds of the largest draw of each pass, in each image."""
    recorded = record.read("draws")
    images = recorded["seconds"]
    rows = [["pass", *images]]
    for name in dict.fromkeys(name for passes in images.values() for name in passes):
        times = (passes.get(name) for passes in images.values())
        rows.append([f"`{name}`", *(f"{median(each):.2f}" if each else "" for each in times)])
    size, sentence = recorded["size"].replace("x", "×"), record.sentence(recorded)
    return f"{error_report.table(rows)}\n\nSeconds; {recorded['scene']}, {size} pixels. {sentence}"


def occlusion_tables() -> str:
    """RMS errors of ambient occlusion beside closed forms, and beside rays of the same radius."""
    recorded = record.read("occlusion")
    closed, rays, names = recorded["closed forms"], recorded["rays"], list(OcclusionSampling)
    rows = [["scene", "darkening", *(each.label for each in names)]]
    rows += [
        [name, *(f"{errors[each]:.3f}" for each in ("darkening", *(str(each) for each in names)))]
        for name, errors in closed.items()
    ]
    counts = list(next(iter(rays.values()))[str(names[0])]["errors"])
    beside = [["scene", "darkening", "sampling", *(f"{count} samples" for count in counts), "ms a sample"]]
    beside += [
        [
            *(scene, f"{errors['darkening']:.3f}", each.label),
            *(f"{errors[str(each)]['errors'][count]:.3f}" for count in counts),
            f"{errors[str(each)]['ms']:.0f}",
        ]
        for scene, errors in rays.items()
        for each in names
    ]
    width, height = recorded["size"]
    sizes = f"{width}×{height} pixels. {record.sentence(recorded)}"
    return f"{error_report.table(rows)}\n\n{error_report.table(beside)}\n\n{sizes}"


#: Generators of the parts between markers of a name; and of whole files, by their paths from the root.
PARTS: dict[str, Callable[[], str]] = {
    "race": goal_table,
    "error after a time": error_after_time,
    "error after samples": error_per_sample,
    "scale": scale_tables,
    "shortcuts": shortcuts_table,
    "atrium": atrium_table,
    "passes": pass_table,
    "small meshes": small_meshes_table,
    "image memory": image_memory_table,
    "large map": large_map_table,
    "gpu": gpu_table,
    "constants": constants_table,
    "draws": draws_table,
    "occlusion": occlusion_tables,
}
PLOTS: dict[str, Callable[[], str]] = {"docs/pictures/error.svg": error_plot, "docs/pictures/scale.svg": scale_plot}
