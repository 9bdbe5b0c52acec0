# SPDX-License-Identifier: GPL-3.0-or-later
"""Uploads to the GPU what has changed in the scene."""
