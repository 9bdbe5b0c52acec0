# SPDX-License-Identifier: GPL-3.0-or-later
"""Benchmarks: modules that dev.py bench runs by name. They measure and assert nothing."""
