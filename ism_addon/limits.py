# SPDX-License-Identifier: GPL-3.0-or-later
"""What becomes of settings that are out of their range: whoever asked is told, and the nearest that is in it is drawn.

Blender keeps its properties in their ranges itself. Scripts, snapshots and the command line can ask for anything; drawn
as it is, that might take all memory, or never be done.
"""

import math
from collections.abc import Iterator
from dataclasses import Field, replace
from typing import Any

from .quoting import cut
from .scene import View
from .settings import SECTIONS, Control, Settings, controls

#: px. Wider ones take long, and show nothing but a blur; Blender has filters of up to 500.
WIDEST_FILTER = 50.0


def within_limits(settings: Settings) -> Settings:
    """The same, but at the end of its range what is beyond it: drawn as it is, it might never be done."""
    for name in SECTIONS:
        section = getattr(settings, name)
        nearest = {member.name: value for member, _, value in _beyond_limits(section)}
        settings = replace(settings, **{name: replace(section, **nearest)})
    return settings


def beyond_limits(settings: Settings) -> tuple[str, ...]:
    """A sentence for each setting that within_limits changes."""
    return tuple(
        f"{control.label} cannot be {cut(f'{getattr(section, member.name):,}')}: {nearest:,} is used instead."
        for section in (getattr(settings, name) for name in SECTIONS)
        for member, control, nearest in _beyond_limits(section)
    )


def view_within_limits(view: View) -> View:
    """The same, with a pixel filter that can be drawn."""
    nearest = min(WIDEST_FILTER, max(0.0, view.filter_width))  # 0 for what is no number
    return view if view.filter_width == nearest else replace(view, filter_width=nearest)


def view_beyond_limits(view: View) -> tuple[str, ...]:
    """A sentence if view_within_limits changes it."""
    nearest = view_within_limits(view).filter_width
    sentence = f"Filter Size cannot be {view.filter_width:g} px: {nearest:g} px is used instead."
    return (sentence,) if view.filter_width != nearest else ()


def _beyond_limits(section: Any) -> Iterator[tuple[Field, Control, int | float]]:
    """The settings of a section that are out of their range, and the end of it that is nearest."""
    for member, control in controls(type(section)):
        if control.low is not None and control.high is not None:
            value = getattr(section, member.name)
            nearest = min(control.high, max(control.low, value))  # the lower end for what is no number
            # In Blender, an end is a float32.
            if value != nearest and (isinstance(value, int) or not math.isclose(value, nearest, rel_tol=1e-6)):
                yield member, control, nearest
