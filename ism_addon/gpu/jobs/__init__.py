# SPDX-License-Identifier: GPL-3.0-or-later
"""The render thread: requests in, images out."""
