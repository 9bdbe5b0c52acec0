# SPDX-License-Identifier: GPL-3.0-or-later
"""How a setting is declared: a dataclass field with its label, meaning, unit and range."""

from collections.abc import Iterator
from dataclasses import Field, dataclass, field, fields
from typing import Any

from ..choices import Choice, Method


@dataclass(frozen=True)
class Control:
    """How a setting appears to the user. Units are Blender's names of property subtypes."""

    label: str
    meaning: str
    low: float | None = None
    high: float | None = None
    soft_high: float | None = None
    unit: str = "NONE"
    method: Method | None = None  # the only method that uses the setting


def setting(default: Any, label: str, meaning: str, method: Method | None = None, **control: Any) -> Any:
    """A dataclass field with its Control as metadata."""
    if method:
        meaning += f". For the method {method.label} only"
    return field(default=default, metadata={"control": Control(label, meaning, method=method, **control)})


def setting_fields(section: type) -> Iterator[tuple[Field, Control]]:
    """The fields of a section that are settings, with their Controls."""
    for member in fields(section):
        if "control" in member.metadata:
            yield member, member.metadata["control"]


def help_text(member: Field, control: Control) -> str:
    """The meaning of a setting; of a choice, also that of each value."""
    choices = type(member.default) if isinstance(member.default, Choice) else ()
    return ". ".join([control.meaning, *(f"{choice}: {choice.meaning}" for choice in choices)])
