# SPDX-License-Identifier: GPL-3.0-or-later
"""What can be seen, and what can stand in the way."""
