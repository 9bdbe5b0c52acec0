# SPDX-License-Identifier: GPL-3.0-or-later
"""What a light sends where nothing hides it."""
