# SPDX-License-Identifier: GPL-3.0-or-later
"""Which lights contribute to which tile, and which of them are visible there."""
