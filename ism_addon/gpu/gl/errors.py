# SPDX-License-Identifier: GPL-3.0-or-later
"""What ends a picture before its time; the messages of OpenGL's are sentences for the artist."""


class NoOpenGL(RuntimeError):
    """This machine gives no usable OpenGL context."""


class ContextLost(RuntimeError):
    """The driver has taken the context away, with all that is in it."""


class Cancelled(Exception):
    """Nobody wants the picture any more."""


class GraphicsError(RuntimeError):
    """OpenGL has not done what was asked of it, so what it has drawn is wrong."""
