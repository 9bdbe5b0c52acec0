# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation's generated parts, and what its tests look at."""
