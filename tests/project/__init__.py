# SPDX-License-Identifier: GPL-3.0-or-later
"""The project itself: its layers, its documentation, its tools."""
