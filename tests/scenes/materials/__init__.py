# SPDX-License-Identifier: GPL-3.0-or-later
"""Benchmark scenes whose materials are node graphs, with gloss, metals, coats, bumps, and leaves cut by alpha."""
