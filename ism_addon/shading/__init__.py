# SPDX-License-Identifier: GPL-3.0-or-later
"""Node graphs of materials, without Blender and OpenGL: operations, their references in numpy, simplification."""

from . import arithmetic, closures, colors, inputs, patterns, textures, vectors  # register their operations

__all__ = ["arithmetic", "closures", "colors", "inputs", "patterns", "textures", "vectors"]
