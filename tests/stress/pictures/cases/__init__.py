# SPDX-License-Identifier: GPL-3.0-or-later
"""Extreme scenes that Cycles can render too: CASES maps a name to a function that makes a scene and its view."""

from . import emissive, lights, meshes, worlds

CASES = meshes.CASES | lights.CASES | worlds.CASES | emissive.CASES
