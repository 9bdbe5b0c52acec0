# SPDX-License-Identifier: GPL-3.0-or-later
"""Benchmark scenes with lights of all types: points, spots, suns and emissive meshes."""
