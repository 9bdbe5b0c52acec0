# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests share: small scenes, their rendering, and reference implementations in float64."""
