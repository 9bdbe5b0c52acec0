# SPDX-License-Identifier: GPL-3.0-or-later
"""Plays scenarios, each in a Blender of its own unless any pace will do; prints a table of the results."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import Any

from tests.tools import blender_root, project

from .scenario import Scenario

PLAYER_SCRIPT = Path(__file__).with_name("play_scenarios.py")
DESKTOP = project.ROOT / "tests/tools/desktop.py"
#: Blender's factory layout gives the 3D viewport this fraction of the window's width and height, less some pixels.
VIEWPORT_FRACTION, VIEWPORT_MARGIN = (0.8286, 0.922), (3.7, 45.8)
#: Blenders that run at a time with --any-pace. Each waits much of its time; it may take this many times as long.
MAX_BLENDERS = 3
#: Scenarios that a Blender plays with --any-pace: it takes as long to start as some of them.
SCENARIOS_PER_BLENDER = 5
#: Pixels of the viewport, where a scenario does not set them, and its maximum width where any pace and size will do.
REGION, ANY_PACE_WIDTH = (1000, 700), 320
STARTUP_SECONDS = 60  # that Blender may take before the scenario begins and after it has ended, together
#: Lines of Blender's log that make a scenario fail. With MESA_DEBUG, Mesa logs OpenGL's errors, in our context too.
ERROR_LINE = re.compile(r"^(Traceback|.*Mesa: User error: GL_|.*could not be drawn).*", re.MULTILINE)


@dataclass(frozen=True)
class Blender:
    """A Blender to start: in a root folder, or on this machine."""

    program: str
    root: Path | None = None

    def command(self, size: str, arguments: list[str], variables: dict[str, str], folders: tuple[Path, ...]) -> list:
        """The command line that starts it on a screen of that size, with access to these folders."""
        settings = ["env", *(f"{name}={value}" for name, value in variables.items())]
        if self.root is None:
            return [*settings, sys.executable, str(DESKTOP), size, self.program, *arguments]
        command = (*settings, "python3", str(DESKTOP), size, self.program, *arguments)
        return blender_root.command_in_root(self.root, *command, folders=folders)


@dataclass
class Outcome:
    """The result of a scenario."""

    name: str
    about: str
    failure: str
    slow: str
    seconds: float
    figures: dict[str, dict]


def play(chosen: Iterable[Scenario], archive: Path, output: Path, blender: Blender, any_pace: bool) -> bool:
    """Play scenarios with the extension in `archive`, and write a record to `output`: whether all pass.

    With `any_pace`, scenarios pass even if something takes longer than its limit, and several share a Blender.
    """
    outcomes = []
    with ThreadPoolExecutor(MAX_BLENDERS if any_pace else 1) as pool:
        play_group = partial(_play, archive=archive, output=output, blender=blender, any_pace=any_pace)
        for group in pool.map(play_group, _groups(chosen, any_pace)):
            for outcome in group:
                print(_report(outcome), flush=True)
                outcomes.append(outcome)
    record = {"commit": project.commit(), "outcomes": [asdict(outcome) for outcome in outcomes]}
    (output / "record.json").write_text(json.dumps(record, indent=1))
    failed = [outcome.name for outcome in outcomes if outcome.failure or (outcome.slow and not any_pace)]
    print(f"failed: {', '.join(failed)}" if failed else f"passed: {len(outcomes)}")
    return not failed


def _groups(chosen: Iterable[Scenario], any_pace: bool) -> list[list[Scenario]]:
    """Scenarios by the Blender that plays them, the longest first. Those of a group have the same size of window."""
    groups: list[list[Scenario]] = []
    together: dict[tuple[int, int], list[Scenario]] = defaultdict(list)
    for scenario in chosen:
        if scenario.alone or not any_pace:
            groups.append([scenario])
        else:
            together[_window_size(scenario, any_pace)].append(scenario)
    for each in together.values():
        groups += [each[first : first + SCENARIOS_PER_BLENDER] for first in range(0, len(each), SCENARIOS_PER_BLENDER)]
    return sorted(groups, key=_timeout, reverse=True)


def _timeout(group: list[Scenario]) -> int:
    """Seconds that the scenarios may take together."""
    return sum(scenario.timeout for scenario in group)


def _window_size(scenario: Scenario, any_pace: bool) -> tuple[int, int]:
    """Width and height, in pixels, of the window in which the viewport has the scenario's size."""
    region = scenario.region or REGION
    scale = min(1.0, ANY_PACE_WIDTH / region[0]) if any_pace and scenario.any_size else 1.0
    width, height = (
        round((scale * pixels + margin) / fraction)
        for pixels, margin, fraction in zip(region, VIEWPORT_MARGIN, VIEWPORT_FRACTION, strict=True)
    )
    return width, height


def _play(group: list[Scenario], archive: Path, output: Path, blender: Blender, any_pace: bool) -> list[Outcome]:
    """Play scenarios one after another. After one that ends Blender, the others are played in a new one."""
    outcomes: list[Outcome] = []
    while rest := group[len(outcomes) :]:
        outcomes += _play_in_one(rest, archive, output, blender, _window_size(rest[0], any_pace))
    return outcomes


def _play_in_one(
    group: list[Scenario], archive: Path, output: Path, blender: Blender, size: tuple[int, int]
) -> list[Outcome]:
    """Play scenarios in one Blender: the outcomes up to that of the one in which it ended."""
    for scenario in group:
        shutil.rmtree(output / scenario.name, ignore_errors=True)
        (output / scenario.name).mkdir(parents=True)
    first = output / group[0].name
    (first / "user").mkdir()
    width, height = map(str, size)
    window = ["--factory-startup", "--window-fullscreen", "--window-geometry", "0", "0", width, height]
    script = ["--python-exit-code", "1", "--python", str(PLAYER_SCRIPT), "--"]
    paths = [f"{scenario.module}.{scenario.name}" for scenario in group]
    variables = {"BLENDER_USER_RESOURCES": str(first / "user"), "MESA_DEBUG": "1", "TMPDIR": str(first)}
    command = blender.command(
        f"{width}x{height}",
        [*window, *script, str(archive), str(output), *paths],
        variables,
        (project.ROOT, archive.parent, *(output / scenario.name for scenario in group)),
    )
    began = time.perf_counter()
    status = _run(command, first / "blender.log", MAX_BLENDERS * _timeout(group) + STARTUP_SECONDS)
    seconds = time.perf_counter() - began
    shutil.rmtree(first / "user")
    return _outcomes(group, output, (first / "blender.log").read_text("utf-8", "replace"), status, seconds)


def _outcomes(group: list[Scenario], output: Path, log: str, status: int | None, seconds: float) -> list[Outcome]:
    """Of the scenarios that Blender has played, by its log, which has the name of each before its messages."""
    begun = [scenario for scenario in group if re.search(_heading(scenario), log)] or group[:1]
    outcomes = []
    for scenario, following in zip_longest(begun, begun[1:]):
        messages = log
        if following is not None:
            messages, log = re.split(_heading(following), log, maxsplit=1)
        errors = list(dict.fromkeys(match[0] for match in ERROR_LINE.finditer(messages)))
        result: dict[str, Any] = {"failure": "", "slow": "", "figures": {}, "seconds": seconds}
        if (path := output / scenario.name / "result.json").is_file():
            result |= json.loads(path.read_text())
        elif status == 0:
            errors.append("Blender ended before the scenario did")
        if following is None and status is None:
            errors.append(f"Blender was still busy after {seconds:.0f} s and has been ended")
        elif following is None and status:
            errors.append("\n".join([f"Blender's exit status is {status}", *messages.strip().splitlines()[-12:]]))
        failure = "\n".join(filter(None, [result["failure"], *errors]))
        figures = result["figures"]
        outcomes.append(Outcome(scenario.name, scenario.about, failure, result["slow"], result["seconds"], figures))
    return outcomes


def _heading(scenario: Scenario) -> str:
    """The pattern of the line that play_scenarios prints before a scenario."""
    return rf"(?m)^scenario {scenario.name}$"


def _run(command: list[str], log: Path, timeout: float) -> int | None:
    """Run a command: its exit status, or None after a timeout, when all processes that it started are ended."""
    with log.open("wb") as output:
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=output, stderr=output, cwd=log.parent, start_new_session=True
        )
        try:
            return process.wait(timeout)
        except subprocess.TimeoutExpired:
            return None
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGTERM)
                time.sleep(0.5)
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


def _report(outcome: Outcome) -> str:
    """A row of the table, with the figures and the errors below."""
    result = "failed" if outcome.failure else "slow  " if outcome.slow else "passed"
    lines = [f"{result}  {outcome.seconds:5.0f} s  {outcome.name}: {outcome.about}"]
    for name, figure in outcome.figures.items():
        bounds = [f"{bound} {figure[bound]:g}" for bound in ("must", "aim") if figure[bound] is not None]
        lines.append(
            f"    {name}: {figure['value']:.4g} {figure['unit']}" + (f"  ({', '.join(bounds)})" if bounds else "")
        )
    return "\n".join(
        [*lines, *(f"    ! {line}" for line in (outcome.failure + "\n" + outcome.slow).split("\n") if line)]
    )
