# SPDX-License-Identifier: GPL-3.0-or-later
"""Real tests: what they check is drawn, never pretended."""
