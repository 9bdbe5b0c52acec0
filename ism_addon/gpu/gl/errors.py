# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors that end a render early. Messages are sentences for the artist."""


class NoOpenGL(RuntimeError):
    """No usable OpenGL context can be opened."""


class ContextLost(RuntimeError):
    """The driver has lost the context with all its objects."""


class Cancelled(Exception):
    """The render was cancelled."""


class GraphicsError(RuntimeError):
    """An OpenGL call has failed, so the image is wrong."""
