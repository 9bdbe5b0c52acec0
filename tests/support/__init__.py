# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests share: small scenes, pictures of them, and references in float64."""
