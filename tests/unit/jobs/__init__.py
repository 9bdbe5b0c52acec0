# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of ism_addon/gpu/jobs: the render thread, and cancellation."""
