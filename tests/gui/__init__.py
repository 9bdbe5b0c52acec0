# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenarios in a real Blender with a window: `python3 dev.py gui-test [NAME …]`.

Outside Blender, with the standard library alone: `scenario` lists the scenarios, `run_scenarios` starts Blenders
and prints the table of results.

Inside Blender: `play_scenarios` plays scenarios on a `session`. `engine_calls` records Blender's calls of the engine,
`heartbeat` how long the main loop was blocked; `screenshots` reads and compares pictures of the window. `updates`
asserts that the picture is right after an edit. `scene_setup` builds scenes, `random_edits` changes them, `final`
renders them by F12. `engine` is the only module that uses the engine's internals; `blank_engine` draws nothing, for
comparison.
"""
