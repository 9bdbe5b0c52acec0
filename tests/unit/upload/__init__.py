# SPDX-License-Identifier: GPL-3.0-or-later
"""The passes that bring a scene to the GPU."""
