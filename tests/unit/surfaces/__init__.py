# SPDX-License-Identifier: GPL-3.0-or-later
"""The passes that find what the camera sees."""
