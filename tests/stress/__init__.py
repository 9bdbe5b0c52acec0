# SPDX-License-Identifier: GPL-3.0-or-later
"""Stress tests: extreme scenes and values, faults, and long use, each with a bound of the error."""
