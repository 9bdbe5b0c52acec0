# SPDX-License-Identifier: GPL-3.0-or-later
"""Modules of dev.py, which use the standard library alone, because it runs before anything is installed; test tools."""
