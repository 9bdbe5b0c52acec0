# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's light, and the ambient occlusion of it."""
