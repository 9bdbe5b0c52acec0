# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's meshes, instances and materials as buffers that shaders read."""
