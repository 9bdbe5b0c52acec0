# SPDX-License-Identifier: GPL-3.0-or-later
"""Ambient occlusion, from what is on the screen or by rays."""
