# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of scenes at the ends of what there is."""
