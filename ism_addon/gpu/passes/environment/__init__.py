# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's light and its ambient occlusion."""
