# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light by shadow rays: predicted, then corrected (Heitz, Hill & McGuire 2018)."""
