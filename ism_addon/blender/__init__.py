# SPDX-License-Identifier: GPL-3.0-or-later
"""The only floor that knows Blender's data: reads it, runs the engine, shows the picture.

extract    an evaluated depsgraph to one Scene
meshes     one evaluated mesh to triangles with corner normals
nodes      what feeds a shader's sockets
materials  shaders to base colours and images
images     Blender's images to texels
unlike     what of a material is not drawn
lights     area lights to radiance and axes
emission   what a light's nodes make of it
world      the background's radiance
camera     the final render's and the viewport's View
asked      what a scene, its camera and its view layer ask for and is not drawn
findings   what had to be left out, in sentences
engine     the render engine
final      the final render: samples into Blender's passes
viewport   a 3D viewport: the latest picture, and the next one asked for
present    a picture into the viewport
controls   what the user has turned: scene.ism to Settings
"""
