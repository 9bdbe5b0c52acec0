# SPDX-License-Identifier: GPL-3.0-or-later
"""The method on the GPU, pass by pass, without Blender: python -m ism_addon.gpu scene.npz -o out.png

renderer   the tuple of passes and the loop
worker     the thread that owns the OpenGL context: requests in, pictures out
"""
