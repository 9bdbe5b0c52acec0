# SPDX-License-Identifier: GPL-3.0-or-later
"""Features of the panels: debug views, reloaded shaders, snapshots, presets, animated settings, preview icons."""

import bpy
import numpy as np

from tests.gui import engine, scene_setup
from tests.gui.scenario import scenario
from tests.gui.screenshots import WITHOUT_BORDER, rmse
from tests.gui.session import Session, Steps

#: Debug views: a point of the studio, in world space, and the linear colour that they show there.
TARGETS = {
    "base_color": ((0.0, 0.0, 0.0), (0.8, 0.8, 0.8)),
    "normal": ((-0.9, -0.6, 0.6), (0.5, 0.0, 0.5)),  # on the cube's front side
}


@scenario(region=(600, 420))
def debug_views(session: Session) -> Steps:
    """A debug view shows a render target; switched back, or with reloaded shaders, the picture is the first one."""
    yield from _show_studio(session)
    first = session.pixels("picture")
    for name, (point, linear) in TARGETS.items():
        session.scene.ism.debug_view = name
        yield from session.until_idle()
        u, v = session.region_uv(point)
        shown = session.pixels(name)
        color = shown[round((1.0 - v) * len(shown)), round(u * len(shown[0]))]
        expected = [1.055 * value ** (1.0 / 2.4) - 0.055 if value else 0.0 for value in linear]
        session.record(f"{name}: off by", 255 * np.abs(color - expected).max(), "/255", must=2)
    session.scene.ism.debug_view = "sample_color"
    yield from session.until_idle()
    session.record("the picture again, RMSE", 255 * rmse(first, session.pixels("again")), "/255", must=1, aim=0)
    jobs = engine.jobs()
    with session.in_viewport():
        bpy.ops.ism.reload_shaders()
    yield from session.until_idle()
    assert engine.jobs() != jobs, "nothing was rendered after the shaders were reloaded"
    session.record("shaders anew, RMSE", 255 * rmse(first, session.pixels("shaders anew")), "/255", must=1, aim=0)


@scenario(region=(600, 420), alone=True)
def saved_snapshot(session: Session) -> Steps:
    """A snapshot saved from the viewport and rendered without Blender is the viewport's picture, also in local view."""
    yield from _show_studio(session)
    yield from _assert_snapshot(session, "all of the scene")
    with session.in_viewport():
        bpy.data.objects["Cube"].select_set(True)
        bpy.ops.view3d.localview(frame_selected=False)
    yield from _assert_snapshot(session, "local view")
    with session.in_viewport():
        bpy.ops.view3d.localview(frame_selected=False)
    bpy.context.preferences.view.ui_scale = 2.0
    yield from _assert_snapshot(session, "twice the scale of the window")


def _assert_snapshot(session: Session, name: str) -> Steps:
    yield from session.until_idle()
    path = session.folder / f"{name}.npz"
    with session.in_viewport():
        bpy.ops.ism.save_snapshot(filepath=str(path))
    shown, rendered = session.pixels(f"{name}, seen"), engine.render_snapshot(path)
    session.record(f"{name}, RMSE", 255 * rmse(shown[WITHOUT_BORDER], rendered[WITHOUT_BORDER]), "/255", must=1, aim=0)


@scenario(region=(600, 420))
def presets(session: Session) -> Steps:
    """A preset changes the quality and the picture; undo restores both."""
    yield from _show_studio(session)
    session.scene.ism.viewport.samples = 5  # no preset has this number
    yield from session.until_idle()
    first = session.pixels("before")
    session.push_undo("Before")
    (folder,) = bpy.utils.preset_paths("ism/quality")
    for name, samples, percent in (("Draft", 4, "50"), ("Final", 64, "100")):
        with session.in_viewport():
            bpy.ops.script.execute_preset(filepath=f"{folder}/{name}.py", menu_idname="ISM_RENDER_PT_presets")
        assert _quality(session) == (samples, percent), f"{name} does not set the quality"
        yield from session.until_idle()
        changed = np.abs(session.pixels(name) - first)[WITHOUT_BORDER].max()
        assert changed > 0.1, f"{name} does not change the picture"
        with session.in_viewport():
            bpy.ops.ed.undo()
        assert _quality(session) == (5, "100"), f"{name} cannot be undone"
        yield from session.until_idle()
        session.record(
            f"{name} undone, RMSE", 255 * rmse(first, session.pixels(f"{name} undone")), "/255", must=1, aim=0
        )


def _quality(session: Session) -> tuple[int, str]:
    viewport = session.scene.ism.viewport
    return viewport.samples, viewport.resolution


@scenario(region=(600, 420))
def animated_settings(session: Session) -> Steps:
    """Settings with keyframes and drivers: each frame's picture is that of its values set by hand."""
    yield from _show_studio(session)
    scene_setup.set_world(0.9)
    bpy.data.lights["Lamp"].energy = 10.0
    ssao = session.scene.ism.ssao
    set_by_hand = {}
    for radius, intensity in ((0.1, 1.0), (2.0, 1.0), (2.0, 3.0)):
        ssao.radius, ssao.intensity = radius, intensity
        yield from session.until_idle()
        picture = session.pixels(f"by hand, {radius} and {intensity}")
        assert all(rmse(picture, other) > 0.01 for other in set_by_hand.values()), "the values make no difference"
        set_by_hand[radius, intensity] = picture
    for frame, ssao.radius in ((1, 0.1), (10, 2.0)):
        ssao.keyframe_insert("radius", frame=frame)
    ssao.intensity = 1.0
    for frame, radius in ((1, 0.1), (10, 2.0), (1, 0.1)):
        yield from _assert_frame(session, f"keyframes, {frame}", frame, set_by_hand[radius, 1.0])
    ssao.driver_add("intensity").driver.expression = "1 if frame <= 10 else 3"
    for frame, radius, intensity in ((11, 2.0, 3.0), (10, 2.0, 1.0), (1, 0.1, 1.0)):
        yield from _assert_frame(session, f"driver, {frame}", frame, set_by_hand[radius, intensity])


def _assert_frame(session: Session, name: str, frame: int, expected: np.ndarray) -> Steps:
    session.scene.frame_set(frame)
    yield from session.until_idle()
    session.record(f"{name}, RMSE", 255 * rmse(session.pixels(name), expected), "/255", must=1, aim=0)


@scenario(region=(600, 420))
def preview_icons(session: Session) -> Steps:
    """The preview icons of a material, a light and a world are rendered by our engine."""
    yield from _show_studio(session)
    light, world = bpy.data.lights["Lamp"], session.scene.world
    light.energy, light.color = 2.0, (1.0, 0.2, 0.05)
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.05, 0.2, 0.7, 1.0)
    green = scene_setup.new_material("Green", (0.05, 0.7, 0.1))
    for data, brightest_channel in ((green, 1), (light, 0), (world, 2)):
        preview = data.preview_ensure()
        with session.in_viewport():
            data.asset_generate_preview()
        yield from session.until(lambda preview=preview: any(preview.image_pixels), 30, f"a preview of {data.name}")
        yield from session.until(lambda: not bpy.app.is_job_running("RENDER_PREVIEW"), 30, "the preview is done")
        width, height = preview.image_size
        pixels = np.array(preview.image_pixels_float).reshape(height, width, 4)
        middle = pixels[height // 2, width // 2, :3]
        others = np.delete(middle, brightest_channel).max()
        # Of the lamp's, Cycles makes (0.20, 0.08, 0.02).
        assert middle[brightest_channel] > 0.1 + others, f"the preview of {data.name} is {middle} in the middle"


def _show_studio(session: Session) -> Steps:
    scene_setup.build_studio()
    session.scene.view_settings.view_transform = "Standard"
    yield from session.until_drawn()
