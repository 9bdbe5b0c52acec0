# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenarios in a real Blender with a window: `python3 dev.py gui-test [NAME …]`.

Outside Blender, with the standard library alone: `scenario` (what a scenario is, and which there are) and `outside`
(a Blender for each, and the table). Inside: `inside` plays one scenario on a `session`; `watch` looks over the engine's
shoulder, `heartbeat` at Blender's main loop, `sight` at the window's pixels; `follow` asks whether the picture is right
after each act; `engine` is the only one that knows the engine's inside, `blank` is one to compare it with; `scenery`
builds what is seen, `final` renders it by F12.
"""
