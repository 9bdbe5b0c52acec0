# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo's scene in Blender's window with its panels: the README's screenshot."""

import os
import subprocess
import time
from pathlib import Path

import bpy

from tests.gui.scenario import scenario
from tests.gui.session import Session, Steps

ROOT = Path(__file__).parents[3]
BUILD = "import sys; sys.path.insert(0, sys.argv[-2]); from tests.scenes import atrium; atrium.build(sys.argv[-1])"


@scenario(region=(1280, 720), timeout=240)
def atrium(session: Session) -> Steps:
    """The atrium through its camera, with the engine's panels beside it."""
    path = session.folder / "atrium.blend"
    build = [bpy.app.binary_path, "-b", "--factory-startup", "--python-exit-code", "1", "--python-expr", BUILD]
    # With other user resources than ours: a Blender that starts without our extension removes its packages.
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(session.folder / "builder")}
    subprocess.run([*build, "--", str(ROOT), str(path)], check=True, env=environment)
    bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False)
    from tests.scenes.atrium_light import set_up_occlusion  # imported here: it uses data of the loaded file

    set_up_occlusion(session.scene.ism)
    session.view.view_perspective = "CAMERA"
    session.view.view_camera_zoom, session.view.view_camera_offset = 30.2, (0.0, 0.0)
    session.space.overlay.show_overlays = session.space.show_gizmo = False
    properties = next(area for area in session.window.screen.areas if area.type == "PROPERTIES")
    properties.spaces.active.context = "RENDER"
    began = time.perf_counter()
    session.show_rendered()
    yield from session.until_idle(200)
    session.record("from opening to the last sample", time.perf_counter() - began, "s")
    properties.tag_redraw()
    yield from session.wait(0.5)
    shown = session.pixels("atrium")
    assert shown.std() > 0.1, "the picture of the atrium is empty"
