# SPDX-License-Identifier: GPL-3.0-or-later
"""Time and memory of a picture as one thing grows, and all else stays as it is."""
