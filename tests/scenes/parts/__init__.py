# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scenes are built of: shapes, materials, textures."""
