# SPDX-License-Identifier: GPL-3.0-or-later
"""The thread that draws: requests in, images out."""
