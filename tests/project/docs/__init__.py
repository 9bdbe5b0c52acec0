# SPDX-License-Identifier: GPL-3.0-or-later
"""The documentation: its links, commands, generated parts and messages."""
