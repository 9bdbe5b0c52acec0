# SPDX-License-Identifier: GPL-3.0-or-later
"""The passes that make one picture of samples."""
