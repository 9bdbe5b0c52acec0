# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a scene with OpenGL, without Blender: python -m ism_addon.gpu scene.npz -o out.png"""
