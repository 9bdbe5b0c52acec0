# SPDX-License-Identifier: GPL-3.0-or-later
"""Node graphs: operations, building and compiling."""
