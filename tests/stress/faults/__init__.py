# SPDX-License-Identifier: GPL-3.0-or-later
"""Broken files, a broken OpenGL, interruptions, and long use."""
