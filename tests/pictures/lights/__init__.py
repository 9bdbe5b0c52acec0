# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of single types of lights, and of what their properties change."""
