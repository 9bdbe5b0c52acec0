# SPDX-License-Identifier: GPL-3.0-or-later
"""Which lights matter in which tile, and which of them arrive there."""
