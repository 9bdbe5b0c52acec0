# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes on the GPU."""
