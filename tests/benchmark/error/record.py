# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything measured, and on what, as JSON."""

import json
import math
import os
import platform
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path

import bpy

from ism_addon.gpu.gl.context import Device
from tests.tools import project

from .curve import time_to
from .race import Result
from .report import GOAL, wins

PACKAGES = ("numpy", "moderngl", "flip-evaluator", "matplotlib")


def write(
    path: Path, results: Mapping[str, Result], ours: Sequence[str], effort: object, device: Device, tuning: bool
) -> None:
    """The record of one run."""
    record = {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": machine(device),
        "versions": {"blender": bpy.app.version_string} | {name: metadata.version(name) for name in PACKAGES},
        "commit": project.commit(),
        "tuning": tuning,
        "effort": asdict(effort),
        "scenes": {name: told(result, ours) for name, result in results.items()},
    }
    path.write_text(json.dumps(record, indent=1, allow_nan=False), "utf-8")


def machine(device: Device) -> dict[str, object]:
    """What it ran on."""
    model = [line.partition(":")[2].strip() for line in _lines("/proc/cpuinfo") if line.startswith("model name")]
    return {
        "system": platform.platform(),
        "processor": model[0] if model else platform.processor(),
        "cores": os.cpu_count(),
        "opengl": device.name,
    }


def told(result: Result, ours: Sequence[str]) -> dict[str, object]:
    """One scene."""
    curves = result.curves
    races = {name: time_to(points, GOAL) for name, points in curves.items()}
    return {
        "facts": result.facts,
        "not counted": result.starts,
        "missing": result.missing,
        f"seconds to {GOAL:g}": {name: t if math.isfinite(t) else None for name, t in races.items()},
        "below both Cycles": {name: wins(curves, name) for name in ours},
        "medians": {name: [asdict(point) for point in points] for name, points in curves.items()},
        "rounds": {
            name: [[asdict(point) for point in points] for points in rounds] for name, rounds in result.rounds.items()
        },
    }


def _lines(path: str) -> list[str]:
    return Path(path).read_text().splitlines() if Path(path).exists() else []
