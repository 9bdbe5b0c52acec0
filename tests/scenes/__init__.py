# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes made by script: the demo's atrium, small scenes as pure data, and their truth from Cycles."""
