# SPDX-License-Identifier: GPL-3.0-or-later
"""Soft shadows by imperfect shadow maps: a map of the house.

settings    every number a user can turn
limits      what becomes of those that are out of their range
scene       what a picture is made of, as arrays
ranges      how large its numbers may be
snapshot    scene, view and settings to one .npz and back
files       written whole or not at all
quoting     what sentences quote of a file
spaces      matrices between spaces, and the naming rule
radiometry  Blender's watts and metres to radiance and irradiance
color       linear light and sRGB
sampling    points on triangles, on lights and in pixels
gpu         the method, pass by pass, without Blender (python -m ism_addon.gpu)
blender     reads Blender's data, runs the engine, shows the picture
ui          properties, panels, operators and presets
addon       what registers with Blender, and in which order
"""
