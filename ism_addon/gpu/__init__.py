# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a scene with OpenGL, pass by pass, without Blender: python -m ism_addon.gpu scene.npz -o out.png"""
