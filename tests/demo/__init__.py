# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo: a figure of the report, and the pictures of docs/method.md."""
