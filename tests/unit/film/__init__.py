# SPDX-License-Identifier: GPL-3.0-or-later
"""The passes that combine samples into an image."""
