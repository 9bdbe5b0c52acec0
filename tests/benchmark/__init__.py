# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements, each a module that dev.py bench runs by its name. They report; they judge nothing."""
