# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of docs/settings.md, made from settings.py."""

from dataclasses import Field
from typing import Any

from ism_addon.choices import Choice
from ism_addon.settings import FINAL, SECTIONS, VIEWPORT, Settings
from ism_addon.settings.setting_fields import Control, setting_fields

#: By the path in scripts: the title of a group of settings, and the class that declares them.
GROUPS = {
    "scene.ism.shadow": ("Look of the shadows", SECTIONS["shadow"]),
    "scene.ism.ssao": ("Look of the ambient occlusion", SECTIONS["ssao"]),
    "scene.ism.render` and `scene.ism.viewport": ("Quality of final renders and of the viewport", type(VIEWPORT)),
    "scene.ism": ("For developers", Settings),
}
UNITS = {"DISTANCE": " m", "TIME_ABSOLUTE": " s", "PIXEL": " px"}


def tables() -> str:
    """A heading and a table for each group, then the values of its enumerated settings."""
    parts = []
    for path, (title, section) in GROUPS.items():
        members = list(setting_fields(section))
        rows = [row(section, member, control) for member, control in members]
        heading = ["| name | in the panels | default | range | what it does |", "|---|---|---|---|---|"]
        parts += [f"### {title}: `{path}`", "\n".join([*heading, *rows])]
        parts += [values(member) for member, _ in members if isinstance(member.default, Choice)]
    return "\n\n".join(parts)


def row(section: type, member: Field, control: Control) -> str:
    """One setting. Angles are stored in radians and shown in degrees."""
    bounds = (control.low, control.high)
    allowed = "–" if None in bounds else " to ".join(quantity(control, bound) for bound in bounds)
    cells = f"`{member.name}`", control.label, default(section, member, control), allowed, f"{control.meaning}."
    return f"| {' | '.join(cells)} |"


def default(section: type, member: Field, control: Control) -> str:
    """A setting's default; two values where the viewport's differs from that of final renders."""
    value = member.default
    if section is not type(VIEWPORT):
        return value_text(control, value)
    if not hasattr(FINAL, member.name):
        return f"viewport only: {value_text(control, value)}"
    final, viewport = getattr(FINAL, member.name), getattr(VIEWPORT, member.name)
    return value_text(control, final) + (f", viewport {value_text(control, viewport)}" if final != viewport else "")


def value_text(control: Control, value: object) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    return f"`{value}`" if isinstance(value, str) else quantity(control, value)


def quantity(control: Control, value: Any) -> str:
    """A value with its unit."""
    if isinstance(value, tuple):
        return ", ".join(quantity(control, each) for each in value)
    if control.unit == "ANGLE":
        return f"{value:.4g} rad"
    text = f"{value:,.0f}" if value == int(value) else f"{value:g}"
    return text + UNITS.get(control.unit, "")


def values(member: Field) -> str:
    """The values of an enumerated setting."""
    rows = [f"| `{choice}` | {choice.label} | {choice.meaning}. |" for choice in type(member.default)]
    return "\n".join([f"| `{member.name}` | in the panels | meaning |", "|---|---|---|", *rows])
