# SPDX-License-Identifier: GPL-3.0-or-later
"""Wraps contexts of glcontext, so that moderngl and other callers get other functions in place of OpenGL's."""

from collections.abc import Callable
from typing import Any

import glcontext


class ContextWrapper:
    """Takes the place of one context. Subclasses define `load`, which returns the address of a function."""

    def __init__(self, context: Any):
        self.context = context

    def __enter__(self) -> object:
        return self.context.__enter__()

    def __exit__(self, *reason: object) -> object:
        return self.context.__exit__(*reason)

    def release(self) -> None:
        self.context.release()


def wrap_contexts(monkeypatch: Any, make: Callable[[Any], ContextWrapper]) -> list[Any]:
    """Wrap all contexts that are opened from now on, by `make`: their wrappers are added to the list."""
    opened: list[ContextWrapper] = []
    get_backend = glcontext.get_backend_by_name

    def get_wrapping_backend(name: str) -> Callable[..., ContextWrapper]:
        def open_wrapped(*arguments: object, **settings: object) -> ContextWrapper:
            opened.append(make(get_backend(name)(*arguments, **settings)))
            return opened[-1]

        return open_wrapped

    monkeypatch.setattr(glcontext, "get_backend_by_name", get_wrapping_backend)
    return opened
