# SPDX-License-Identifier: GPL-3.0-or-later
"""What the camera sees, in the tiles that take part in a sample."""
