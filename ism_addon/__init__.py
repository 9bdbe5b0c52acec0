# SPDX-License-Identifier: GPL-3.0-or-later
"""Soft shadows of area, point and spot lights for Blender: by shadow rays, or by imperfect shadow maps.

`settings`, `render_passes`, `scene`, `sampling`, `spaces`, `radiometry`, `color` and `snapshot` need numpy only. `gpu`
renders without Blender (python -m ism_addon.gpu). `blender` reads Blender's data, runs the engine and shows the image.
`ui` has panels, properties and presets. `addon` registers all with Blender.
"""
