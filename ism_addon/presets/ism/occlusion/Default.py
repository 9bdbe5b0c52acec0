# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings' defaults, which every preset begins with."""
