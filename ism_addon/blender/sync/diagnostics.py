# SPDX-License-Identifier: GPL-3.0-or-later
"""What had to be left out of a scene, as one sentence a kind, however often it was seen."""

from collections import Counter


class Diagnostics:
    """Collects kinds of trouble, the names of what has it, and how much of it."""

    def __init__(self) -> None:
        self._kinds: dict[str, Counter[str]] = {}

    def note(self, kind: str, name: str, count: int = 1) -> None:
        """Remember that `name` has this trouble; `kind` is a clause that names may follow after a colon."""
        if count:
            self._kinds.setdefault(kind, Counter())[name] += count

    def include(self, others: "Diagnostics") -> None:
        """Add all that others hold."""
        for kind, names in others._kinds.items():
            self._kinds.setdefault(kind, Counter()).update(names)

    def sentences(self) -> tuple[str, ...]:
        """One a kind, in the order in which they were first seen."""
        return tuple(f"{kind}: {_listed(names)}." for kind, names in self._kinds.items())


def _listed(names: Counter[str], most: int = 3) -> str:
    shown = [f"'{name}'" + (f" ({count})" if count > 1 else "") for name, count in list(names.items())[:most]]
    if len(names) > most:
        shown.append(f"{len(names) - most} more")
    return ", ".join(shown)
