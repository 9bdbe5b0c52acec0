# SPDX-License-Identifier: GPL-3.0-or-later
"""What dev.py is made of: the standard library alone, because it runs before anything is installed."""
