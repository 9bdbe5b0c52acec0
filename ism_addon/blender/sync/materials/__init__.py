# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, their nodes and their images."""
