# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways to look at a scene: turning it, through the camera, in part, from four sides."""

import time

import bpy
import numpy as np
from mathutils import Quaternion

from tests.gui import engine, final, scenery
from tests.gui.scenario import scenario
from tests.gui.sight import INSIDE, picture, rmse
from tests.gui.stage import Stage, Steps


@scenario(region=(1280, 720), patience=240)
def orbit(stage: Stage) -> Steps:
    """The view is turned in 30 steps: pictures on the way, none unlit, and no reading of the scene."""
    scenery.crowd()
    yield from stage.settled(9.0)
    bright = stage.pixels("before").mean()
    start = stage.view.view_rotation.copy()
    stage.watch.place = (0.5, 0.5)
    since = time.perf_counter()
    for step in range(1, 31):
        stage.view.view_rotation = Quaternion((0.0, 0.0, 1.0), 0.05 * step) @ start
        stage.area.tag_redraw()
        yield from stage.wait(0.1)
        if step % 15 == 0:
            brightness = stage.pixels(f"step {step}").mean() / bright
            assert 0.6 < brightness < 1.6, f"step {step} is {brightness:.2f} times as bright as the view before"
    took = time.perf_counter() - since
    updates = [call for call in stage.watch.calls if call.name == "view_update" and call.began >= since]
    stage.measured("orbit", took, "s")
    colors = [tuple(call.seen) for call in stage.watch.glimpses(since)]
    pictures = len(set(colors)) - 1
    stage.measured("orbit: a new picture every", took / max(1, pictures), "s", must=1, aim=0.25)
    stage.measured("orbit: longest redraw", 1e3 * stage.watch.longest_redraw(since), "ms", must=30, aim=10)
    stage.measured("orbit: readings of the scene", len(updates), must=0)
    yield from stage.rested()
    turn = lambda: setattr(stage.view, "view_rotation", start)  # noqa: E731
    seconds = yield from stage.seen(turn, stage.place_of((0.0, -0.5, 0.35)))
    stage.measured("first picture after a turn", seconds, "s", must=1, aim=0.25)
    yield from stage.rested()


@scenario(patience=180)
def camera_against_final(stage: Stage) -> Steps:
    """The camera's view, converged, is what F12 renders in the same size."""
    scenery.studio()
    scenery.camera()
    stage.bare()
    stage.rendered()
    yield from stage.turns()
    final.through_camera(stage)
    yield from stage.rested()
    seen = stage.pixels("viewport")
    path = stage.folder / "final.png"
    final.render(stage, path)
    rendered = picture(path)
    stage.measured("viewport against F12, RMSE", 255 * rmse(seen[INSIDE], rendered[INSIDE]), "/255", must=1, aim=0)
    stage.measured("viewport against F12, largest", 255 * np.abs(seen - rendered)[INSIDE].max(), "/255")


@scenario(patience=180)
def render_region(stage: Stage) -> Steps:
    """With a render region, its inside is as before and its outside has no picture."""
    scenery.studio()
    yield from stage.settled()
    whole = stage.pixels("whole")
    with stage.in_viewport():
        rows, columns = whole.shape[:2]
        left, right, top, bottom = columns // 4, columns // 2, rows // 4, 3 * rows // 4
        bpy.ops.view3d.render_border(xmin=left, xmax=right, ymin=rows - bottom, ymax=rows - top)
    assert stage.space.use_render_border
    yield from stage.rested()
    part = stage.pixels("part")
    inside = np.s_[top + 4 : bottom - 4, left + 4 : right - 4]
    stage.measured("inside, RMSE", 255 * rmse(whole[inside], part[inside]), "/255", must=1)
    assert rmse(whole[:, right + 8 :], part[:, right + 8 :]) > 0.05, "the picture goes on outside the render region"
    with stage.in_viewport():
        bpy.ops.view3d.clear_render_border()
    yield from stage.rested()
    stage.measured("cleared, RMSE", 255 * rmse(whole, stage.pixels("cleared")), "/255", must=1)


@scenario(patience=180)
def camera_border(stage: Stage) -> Steps:
    """Through the camera, the border of its render is what is drawn, wherever its frame is in the viewport."""
    scenery.studio()
    scenery.camera()
    stage.bare()
    stage.rendered()
    yield from stage.turns()
    stage.view.view_perspective = "CAMERA"
    stage.view.view_camera_zoom, stage.view.view_camera_offset = 5.0, (0.1, -0.05)
    yield from stage.rested()
    whole = stage.pixels("whole")
    render, camera = stage.scene.render, stage.scene.camera
    render.use_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.375, 0.75
    frame = [camera.matrix_world @ corner for corner in camera.data.view_frame(scene=stage.scene)]
    left, bottom = np.min([stage.place_of(corner) for corner in frame], axis=0)
    right, top = np.max([stage.place_of(corner) for corner in frame], axis=0)
    yield from stage.rested()
    part = stage.pixels("part")
    rows, columns = whole.shape[:2]
    x = np.round((left + (right - left) * np.array([0.25, 0.75])) * columns).astype(int)
    y = np.round((1.0 - bottom - (top - bottom) * np.array([0.75, 0.375])) * rows).astype(int)
    inside = np.s_[y[0] + 4 : y[1] - 4, x[0] + 4 : x[1] - 4]
    stage.measured("inside, RMSE", 255 * rmse(whole[inside], part[inside]), "/255", must=1)
    for name, side in {"left": np.s_[:, : x[0] - 4], "above": np.s_[: y[0] - 4], "below": np.s_[y[1] + 4 :]}.items():
        assert rmse(whole[side], part[side]) > 0.05, f"the picture goes on {name} of the border"


@scenario(patience=240)
def quad_view(stage: Stage) -> Steps:
    """Four views in one area; then a second area beside it in Solid shading, and each has its own picture."""
    scenery.studio()
    yield from stage.settled()
    with stage.in_viewport():
        bpy.ops.screen.region_quadview()
    yield from stage.rested(90)
    four = stage.pixels_of_area("four views")
    halves = [half for rows in np.array_split(four, 2) for half in np.array_split(rows, 2, axis=1)]
    for index, quarter in enumerate(halves):
        assert quarter.max() - quarter.min() > 0.2, f"view {index} of four is empty"
    with stage.in_viewport():
        bpy.ops.screen.region_quadview()
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.5)
    yield from stage.turns()
    solid = [area for area in stage.window.screen.areas if area.type == "VIEW_3D"][1]
    solid.spaces.active.shading.type = "SOLID"
    yield from stage.rested()
    since = time.perf_counter()
    yield from stage.wait(2.0)
    stage.measured("redraws in 2 s beside Solid shading", stage.watch.redraws(since), must=0, aim=0)
    assert stage.pixels("beside Solid").std() > 0.05, "the rendered half is empty"


@scenario(patience=180)
def material_preview(stage: Stage) -> Steps:
    """A second area in Material Preview comes and goes while ours renders."""
    scenery.studio()
    scenery.look(stage.view)
    stage.rendered()
    yield from stage.rested()
    with stage.in_viewport():
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.5)
    yield from stage.turns()
    stage.scene.ism.viewport.samples = 256
    other = [area for area in stage.window.screen.areas if area.type == "VIEW_3D"][1]
    other.spaces.active.shading.type = "MATERIAL"
    bpy.data.objects["Cube"].data.materials.append(scenery.material("Green", (0.05, 0.8, 0.1)))
    yield from stage.wait(5.0)
    stage.pixels("both")
    other.spaces.active.shading.type = "SOLID"
    stage.scene.ism.viewport.samples = 4
    yield from stage.rested()
    shown = stage.pixels("ours")
    assert (shown[..., 1] - shown[..., 0]).max() > 0.2, "the cube's new material does not show"
    assert not engine.errors()
