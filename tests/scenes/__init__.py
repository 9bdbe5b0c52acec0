# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes built by scripts, as .blend files or as arrays, and reference images of them by Cycles."""
