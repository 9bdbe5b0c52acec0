# SPDX-License-Identifier: GPL-3.0-or-later
"""Radiance to the image: put together, accumulated over samples, and how far it is from its end."""
