# SPDX-License-Identifier: GPL-3.0-or-later
"""Low-discrepancy numbers, each decision by its own; points on triangles, on lights and in pixels."""
