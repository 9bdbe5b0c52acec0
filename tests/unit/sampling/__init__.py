# SPDX-License-Identifier: GPL-3.0-or-later
"""Random numbers, points and pixel grids."""
