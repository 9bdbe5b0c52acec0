# SPDX-License-Identifier: GPL-3.0-or-later
"""The only place here that knows the engine's inside: whether its viewports are done, and what went wrong."""

import importlib
from types import ModuleType
from typing import Any

PACKAGE = "bl_ext.user_default.ism_soft_shadows"


def module(name: str) -> ModuleType:
    """A module of the installed extension, by its name in ism_addon."""
    return importlib.import_module(f"{PACKAGE}.ism_addon.{name}")


def engine_class() -> Any:
    return module("blender.engine").ISMRenderEngine


def is_busy() -> bool:
    """Whether a viewport lacks samples, or has not shown the last."""
    viewports = list(module("blender.lookout")._alive)
    return not viewports or any(
        viewport._job is None or viewport.is_waiting or viewport.has_news for viewport in viewports
    )


def errors() -> list[str]:
    """What the viewports tell their user instead of a picture."""
    jobs = [viewport._job for viewport in module("blender.lookout")._alive]
    return [job.error for job in jobs if job is not None and job.error]
