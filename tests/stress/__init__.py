# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes, values and faults that pictures must survive, each with the error that it may have."""
