# SPDX-License-Identifier: GPL-3.0-or-later
"""The render thread, and pictures that are cancelled."""
