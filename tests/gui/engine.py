# SPDX-License-Identifier: GPL-3.0-or-later
"""Access to the engine's internals: whether its viewports are done, their jobs, errors and statistics."""

import importlib
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from . import screenshots

PACKAGE = "bl_ext.user_default.ism_soft_shadows"


def module(name: str) -> ModuleType:
    """A module of the installed extension, by its name inside ism_addon."""
    return importlib.import_module(f"{PACKAGE}.ism_addon.{name}")


def engine_class() -> Any:
    return module("blender.engine").ISMRenderEngine


def viewports() -> list[Any]:
    """All viewports that our engine draws."""
    return list(module("blender.viewport.redraw_timer")._viewports)


def is_rendering() -> bool:
    """Whether a viewport is still sampling; also before there is a viewport."""
    return not viewports() or any(viewport._job is None or viewport.is_rendering for viewport in viewports())


def is_busy() -> bool:
    """Whether a viewport is still sampling, or has not shown the last sample; also before there is a viewport."""
    return is_rendering() or any(viewport.has_update for viewport in viewports())


def jobs() -> list[Any]:
    """The viewports' latest jobs for the render thread: another object for each new request."""
    return [viewport._job for viewport in viewports()]


def errors() -> list[str]:
    """Error messages that viewports show instead of a picture."""
    return [job.error for job in jobs() if job is not None and job.error]


def pass_milliseconds(*passes: str) -> float:
    """Mean times of these passes in the viewports' latest picture, added."""
    rows = module("blender.render.render_statistics").for_use("viewport")["passes"]
    return sum(rows[name]["ms"] / max(rows[name]["drawn"], 1) for name in passes)


def render_snapshot(snapshot: Path) -> np.ndarray:
    """Render a snapshot by `python -m ism_addon.gpu`, without Blender: display values, top row first."""
    path = snapshot.with_suffix(".png")
    command = [sys.executable, "-m", "ism_addon.gpu", str(snapshot), "-o", str(path)]
    installed = Path(module("gpu").__file__).parents[2]
    packages = {"PYTHONPATH": os.pathsep.join(sys.path)}  # Blender's numpy, and moderngl from the extension's wheels
    subprocess.run(command, cwd=installed, env={**os.environ, **packages}, check=True)
    return screenshots.read_png(path)
