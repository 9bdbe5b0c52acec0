# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands on OpenGL directly."""
