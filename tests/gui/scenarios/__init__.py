# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenarios: generator functions of a session. At each `yield`, Blender's main loop runs."""
