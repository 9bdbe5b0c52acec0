# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo: the figures of the report, drawn again."""
