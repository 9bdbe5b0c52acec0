# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of shader nodes: each node with each of its options, on objects that show what it gives."""
