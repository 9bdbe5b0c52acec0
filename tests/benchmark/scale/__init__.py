# SPDX-License-Identifier: GPL-3.0-or-later
"""Render time and memory as a function of one parameter of a scene, with all others fixed."""
