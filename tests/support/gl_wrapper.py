# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands between moderngl, or whoever else asks, and a context of glcontext's: other functions for OpenGL's."""

from collections.abc import Callable
from typing import Any

import glcontext


class ContextWrapper:
    """In place of one context. Subclasses have `load`, which gives the addresses of functions."""

    def __init__(self, context: Any):
        self.context = context

    def __enter__(self) -> object:
        return self.context.__enter__()

    def __exit__(self, *reason: object) -> object:
        return self.context.__exit__(*reason)

    def release(self) -> None:
        self.context.release()


def wrap_contexts(monkeypatch: Any, make: Callable[[Any], ContextWrapper]) -> list[Any]:
    """Lets what `make` makes of them stand before all contexts that are opened from now on: those are in the list."""
    opened: list[ContextWrapper] = []
    backend = glcontext.get_backend_by_name

    def of_backend(name: str) -> Callable[..., ContextWrapper]:
        def open_behind(*arguments: object, **settings: object) -> ContextWrapper:
            opened.append(make(backend(name)(*arguments, **settings)))
            return opened[-1]

        return open_behind

    monkeypatch.setattr(glcontext, "get_backend_by_name", of_backend)
    return opened
