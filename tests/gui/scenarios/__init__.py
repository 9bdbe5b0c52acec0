# SPDX-License-Identifier: GPL-3.0-or-later
"""Generator functions on a session: each `yield` hands control back to Blender's main loop."""
