# SPDX-License-Identifier: GPL-3.0-or-later
"""The README's table of settings is made from settings.py: python -m tests.project.test_readme prints it anew."""

from dataclasses import Field

from ism_addon.settings import FINAL, SECTIONS, VIEWPORT, Control, DebugView, Settings, help_text, setting_fields
from tests.tools.project import ROOT

HOMES = {
    "scene.ism.shadow": SECTIONS["shadow"],
    "scene.ism.ssao": SECTIONS["ssao"],
    "scene.ism.render and .viewport": type(VIEWPORT),
    "scene.ism": Settings,
}


def table() -> str:
    """A row a setting: where scripts find it, its default, and what it does."""
    lines = []
    for home, section in HOMES.items():
        lines += [f"| `{home}` | default | |", "|---|---|---|"]
        lines += [row(section, member, control) for member, control in setting_fields(section)]
        lines.append("")
    return "\n".join(lines)


def row(section: type, member: Field, control: Control) -> str:
    """One setting. Angles are stored in radians and shown in degrees."""
    value = member.default
    if control.unit == "ANGLE":
        shown = f"{value:.4g} rad"
    elif section is type(VIEWPORT) and not hasattr(FINAL, member.name):
        shown = f"viewport {value}"
    elif section is type(VIEWPORT) and getattr(VIEWPORT, member.name) != value:
        shown = f"{value}, viewport {getattr(VIEWPORT, member.name)}"
    else:
        shown = {True: "on", False: "off"}.get(value, value) if isinstance(value, bool) else value
    meaning = help_text(member, control)
    if member.type is DebugView:
        meaning = f"{control.meaning}: {', '.join(DebugView)}"
    unit = {"DISTANCE": " m", "TIME_ABSOLUTE": " s"}.get(control.unit, "")
    return f"| `{member.name}` | {shown}{unit} | {meaning}. |"


def test_the_readme_has_every_setting_as_it_is():
    assert table() in (ROOT / "README.md").read_text()


if __name__ == "__main__":
    print(table())
