# SPDX-License-Identifier: GPL-3.0-or-later
"""The passes that select the lights that contribute to each tile."""
