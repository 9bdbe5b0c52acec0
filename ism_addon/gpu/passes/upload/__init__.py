# SPDX-License-Identifier: GPL-3.0-or-later
"""What changed in the scene goes to the GPU."""
