# SPDX-License-Identifier: GPL-3.0-or-later
"""Imperfect shadow maps."""
