# SPDX-License-Identifier: GPL-3.0-or-later
"""Views of a scene: orbiting, the camera's, render regions, and several viewports."""

import time

import bpy
import numpy as np
from mathutils import Quaternion

from tests.gui import engine, final, scene_setup
from tests.gui.scenario import scenario
from tests.gui.screenshots import WITHOUT_BORDER, read_png, rmse
from tests.gui.session import Session, Steps


@scenario(region=(1280, 720), timeout=240)
def orbit(session: Session) -> Steps:
    """The view is rotated in 30 steps: new pictures meanwhile, all of them lit, and the scene is not read again."""
    scene_setup.build_many_balls()
    yield from session.until_drawn(9.0)
    first_brightness = session.pixels("before").mean()
    start = session.view.view_rotation.copy()
    session.calls.patch_uv = (0.5, 0.5)
    since = time.perf_counter()
    for step in range(1, 31):
        session.view.view_rotation = Quaternion((0.0, 0.0, 1.0), 0.05 * step) @ start
        session.area.tag_redraw()
        yield from session.wait(0.1)
        if step % 15 == 0:
            brightness = session.pixels(f"step {step}").mean() / first_brightness
            assert 0.6 < brightness < 1.6, f"step {step} is {brightness:.2f} times as bright as the view before"
    duration = time.perf_counter() - since
    updates = [call for call in session.calls.calls if call.name == "view_update" and call.began >= since]
    session.record("orbit", duration, "s")
    colors = [tuple(call.patch_color) for call in session.calls.patch_colors(since)]
    pictures = len(set(colors)) - 1
    session.record("orbit: a new picture every", duration / max(1, pictures), "s", must=1, aim=0.25)
    session.record("orbit: longest redraw", 1e3 * session.calls.longest_redraw(since), "ms", must=30, aim=10)
    session.record("orbit: readings of the scene", len(updates), must=0)
    yield from session.until_idle()
    rotate_back = lambda: setattr(session.view, "view_rotation", start)  # noqa: E731
    seconds = yield from session.until_visible(rotate_back, session.region_uv((0.0, -0.5, 0.35)))
    session.record("first picture after a turn", seconds, "s", must=1, aim=0.25)
    yield from session.until_idle()


@scenario(timeout=180)
def camera_against_final(session: Session) -> Steps:
    """The camera's view after its last sample equals the render by F12 of the same size."""
    scene_setup.build_studio()
    scene_setup.add_camera()
    session.hide_overlays()
    session.show_rendered()
    yield from session.main_loop()
    final.look_through_camera(session)
    yield from session.until_idle()
    shown = session.pixels("viewport")
    path = session.folder / "final.png"
    final.render(session, path)
    rendered = read_png(path)
    session.record(
        "viewport against F12, RMSE", 255 * rmse(shown[WITHOUT_BORDER], rendered[WITHOUT_BORDER]), "/255", must=1, aim=0
    )
    session.record("viewport against F12, largest", 255 * np.abs(shown - rendered)[WITHOUT_BORDER].max(), "/255")


@scenario(region=(480, 336), timeout=180, any_size=False)
def render_region(session: Session) -> Steps:
    """With a render region, the picture inside it is as before, and there is none outside."""
    scene_setup.build_studio()
    yield from session.until_drawn()
    all_pixels = session.pixels("whole")
    with session.in_viewport():
        rows, columns = all_pixels.shape[:2]
        left, right, top, bottom = columns // 4, columns // 2, rows // 4, 3 * rows // 4
        bpy.ops.view3d.render_border(xmin=left, xmax=right, ymin=rows - bottom, ymax=rows - top)
    assert session.space.use_render_border
    yield from session.until_idle()
    region_pixels = session.pixels("part")
    inside = np.s_[top + 4 : bottom - 4, left + 4 : right - 4]
    session.record("inside, RMSE", 255 * rmse(all_pixels[inside], region_pixels[inside]), "/255", must=1)
    assert rmse(all_pixels[:, right + 8 :], region_pixels[:, right + 8 :]) > 0.05, (
        "there is a picture outside the render region"
    )
    with session.in_viewport():
        bpy.ops.view3d.clear_render_border()
    yield from session.until_idle()
    session.record("cleared, RMSE", 255 * rmse(all_pixels, session.pixels("cleared")), "/255", must=1)


@scenario(timeout=180)
def camera_border(session: Session) -> Steps:
    """Through the camera, only its render region is drawn, wherever its frame is in the viewport."""
    scene_setup.build_studio()
    scene_setup.add_camera()
    session.hide_overlays()
    session.show_rendered()
    yield from session.main_loop()
    session.view.view_perspective = "CAMERA"
    session.view.view_camera_zoom, session.view.view_camera_offset = 5.0, (0.1, -0.05)
    yield from session.until_idle()
    all_pixels = session.pixels("whole")
    render, camera = session.scene.render, session.scene.camera
    render.use_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.375, 0.75
    frame = [camera.matrix_world @ corner for corner in camera.data.view_frame(scene=session.scene)]
    left, bottom = np.min([session.region_uv(corner) for corner in frame], axis=0)
    right, top = np.max([session.region_uv(corner) for corner in frame], axis=0)
    yield from session.until_idle()
    region_pixels = session.pixels("part")
    rows, columns = all_pixels.shape[:2]
    x = np.round((left + (right - left) * np.array([0.25, 0.75])) * columns).astype(int)
    y = np.round((1.0 - bottom - (top - bottom) * np.array([0.75, 0.375])) * rows).astype(int)
    inside = np.s_[y[0] + 4 : y[1] - 4, x[0] + 4 : x[1] - 4]
    session.record("inside, RMSE", 255 * rmse(all_pixels[inside], region_pixels[inside]), "/255", must=1)
    for name, side in {"left": np.s_[:, : x[0] - 4], "above": np.s_[: y[0] - 4], "below": np.s_[y[1] + 4 :]}.items():
        assert rmse(all_pixels[side], region_pixels[side]) > 0.05, (
            f"there is a picture outside the render region, {name} of it"
        )


@scenario(timeout=240)
def quad_view(session: Session) -> Steps:
    """Four views in one area, then a second area in Solid shading beside it: each has its own picture."""
    scene_setup.build_studio()
    yield from session.until_drawn()
    with session.in_viewport():
        bpy.ops.screen.region_quadview()
    yield from session.until_idle(90)
    four = session.pixels_of_area("four views")
    quarters = [quarter for rows in np.array_split(four, 2) for quarter in np.array_split(rows, 2, axis=1)]
    for index, quarter in enumerate(quarters):
        assert quarter.max() - quarter.min() > 0.2, f"view {index} of four is empty"
    with session.in_viewport():
        bpy.ops.screen.region_quadview()
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.5)
    yield from session.main_loop()
    solid = [area for area in session.window.screen.areas if area.type == "VIEW_3D"][1]
    solid.spaces.active.shading.type = "SOLID"
    yield from session.until_idle()
    since = time.perf_counter()
    yield from session.wait(2.0)
    session.record("redraws in 2 s beside Solid shading", session.calls.redraws(since), must=0, aim=0)
    assert session.pixels("beside Solid").std() > 0.05, "the area in Rendered shading is empty"


@scenario(timeout=180)
def material_preview(session: Session) -> Steps:
    """A second area switches to Material Preview and back while ours renders."""
    scene_setup.build_studio()
    scene_setup.set_view(session.view)
    session.show_rendered()
    yield from session.until_idle()
    with session.in_viewport():
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.5)
    yield from session.main_loop()
    session.scene.ism.viewport.samples = 256
    other = [area for area in session.window.screen.areas if area.type == "VIEW_3D"][1]
    other.spaces.active.shading.type = "MATERIAL"
    bpy.data.objects["Cube"].data.materials.append(scene_setup.new_material("Green", (0.05, 0.8, 0.1)))
    yield from session.wait(5.0)
    session.pixels("both")
    other.spaces.active.shading.type = "SOLID"
    session.scene.ism.viewport.samples = 4
    yield from session.until_idle()
    shown = session.pixels("ours")
    assert (shown[..., 1] - shown[..., 0]).max() > 0.2, "the cube's new material is not shown"
    assert not engine.errors()
