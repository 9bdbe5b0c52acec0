# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about what this engine does not draw, one sentence for each issue."""

from collections import Counter


class Diagnostics:
    """Collects issues, with the names of the data that have them, and counts."""

    def __init__(self) -> None:
        self._issues: dict[str, Counter[str]] = {}

    def warn(self, issue: str, name: str, count: int = 1) -> None:
        """Record that `name` has an issue: the beginning of a sentence, which ends with a colon and the names."""
        if count:
            self._issues.setdefault(issue, Counter())[name] += count

    def merge(self, others: "Diagnostics") -> None:
        """Add all issues of others."""
        for issue, names in others._issues.items():
            self._issues.setdefault(issue, Counter()).update(names)

    def messages(self) -> tuple[str, ...]:
        """A sentence for each issue, in the order in which they were first recorded."""
        return tuple(f"{issue}: {_listed(names)}." for issue, names in self._issues.items())


def _listed(names: Counter[str], limit: int = 3) -> str:
    shown = [f"'{name}'" + (f" ({count})" if count > 1 else "") for name, count in list(names.items())[:limit]]
    if len(names) > limit:
        shown.append(f"{len(names) - limit} more")
    return ", ".join(shown)
