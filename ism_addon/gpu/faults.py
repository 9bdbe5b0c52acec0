# SPDX-License-Identifier: GPL-3.0-or-later
"""What OpenGL can fail in; the messages are sentences for the artist."""


class NoOpenGL(RuntimeError):
    """This machine gives no usable OpenGL context."""


class ContextLost(RuntimeError):
    """The driver has taken the context away, with all that is in it."""


class GraphicsError(RuntimeError):
    """OpenGL has not done what was asked of it, so what it has drawn is wrong."""
