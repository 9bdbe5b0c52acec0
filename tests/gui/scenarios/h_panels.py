# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels offer: debug views, shaders anew, snapshots, presets, keyframes and drivers, preview icons."""

import bpy
import numpy as np

from tests.gui import engine, scene_setup
from tests.gui.scenario import scenario
from tests.gui.screenshots import WITHOUT_BORDER, rmse
from tests.gui.session import Session, Steps

#: Of debug views: what they show at a place of the studio, linear.
TARGETS = {
    "base_color": ((0.0, 0.0, 0.0), (0.8, 0.8, 0.8)),
    "normal": ((-0.9, -0.6, 0.6), (0.5, 0.0, 0.5)),  # on the cube's side to the front
}


@scenario(region=(600, 420))
def debug_views(session: Session) -> Steps:
    """A debug view shows a target of a pass, and then the picture again; and so do shaders that are read anew."""
    yield from _settle(session)
    first = session.pixels("picture")
    for name, (point, linear) in TARGETS.items():
        session.scene.ism.debug_view = name
        yield from session.until_idle()
        across, up = session.pixel_of(point)
        shown = session.pixels(name)
        texel = shown[round((1.0 - up) * len(shown)), round(across * len(shown[0]))]
        expected = [1.055 * value ** (1.0 / 2.4) - 0.055 if value else 0.0 for value in linear]
        session.measured(f"{name}: off by", 255 * np.abs(texel - expected).max(), "/255", must=2)
    session.scene.ism.debug_view = "sample_color"
    yield from session.until_idle()
    session.measured("the picture again, RMSE", 255 * rmse(first, session.pixels("again")), "/255", must=1, aim=0)
    jobs = engine.jobs()
    with session.in_viewport():
        bpy.ops.ism.reload_shaders()
    yield from session.until_idle()
    assert engine.jobs() != jobs, "the shaders were read anew, and nothing was drawn"
    session.measured("shaders anew, RMSE", 255 * rmse(first, session.pixels("shaders anew")), "/255", must=1, aim=0)


@scenario(region=(600, 420))
def saved_snapshot(session: Session) -> Steps:
    """A snapshot saved from the viewport, drawn without Blender, is what the viewport shows: in local view too."""
    yield from _settle(session)
    yield from _snapshot(session, "all of the scene")
    with session.in_viewport():
        bpy.data.objects["Cube"].select_set(True)
        bpy.ops.view3d.localview(frame_selected=False)
    yield from _snapshot(session, "local view")
    with session.in_viewport():
        bpy.ops.view3d.localview(frame_selected=False)
    bpy.context.preferences.view.ui_scale = 2.0
    yield from _snapshot(session, "twice the scale of the window")


def _snapshot(session: Session, name: str) -> Steps:
    yield from session.until_idle()
    path = session.folder / f"{name}.npz"
    with session.in_viewport():
        bpy.ops.ism.save_snapshot(filepath=str(path))
    seen, drawn = session.pixels(f"{name}, seen"), engine.drawn(path)
    session.measured(f"{name}, RMSE", 255 * rmse(seen[WITHOUT_BORDER], drawn[WITHOUT_BORDER]), "/255", must=1, aim=0)


@scenario(region=(600, 420))
def presets(session: Session) -> Steps:
    """A preset sets the quality and is seen; undone, all is as before."""
    yield from _settle(session)
    session.scene.ism.viewport.samples = 5  # what no preset has
    yield from session.until_idle()
    first = session.pixels("before")
    session.remember("Before")
    (folder,) = bpy.utils.preset_paths("ism/quality")
    for name, samples, percent in (("Draft", 4, "50"), ("Final", 64, "100")):
        with session.in_viewport():
            bpy.ops.script.execute_preset(filepath=f"{folder}/{name}.py", menu_idname="ISM_RENDER_PT_presets")
        assert _quality(session) == (samples, percent), f"{name} does not set the quality"
        yield from session.until_idle()
        changed = np.abs(session.pixels(name) - first)[WITHOUT_BORDER].max()
        assert changed > 0.1, f"{name} is not seen"
        with session.in_viewport():
            bpy.ops.ed.undo()
        assert _quality(session) == (5, "100"), f"{name} cannot be undone"
        yield from session.until_idle()
        session.measured(
            f"{name} undone, RMSE", 255 * rmse(first, session.pixels(f"{name} undone")), "/255", must=1, aim=0
        )


def _quality(session: Session) -> tuple[int, str]:
    viewport = session.scene.ism.viewport
    return viewport.samples, viewport.resolution


@scenario(region=(600, 420))
def animated_settings(session: Session) -> Steps:
    """Keyframes and drivers of settings are followed from frame to frame."""
    yield from _settle(session)
    scene_setup.world(0.9)
    bpy.data.lights["Lamp"].energy = 10.0
    ssao = session.scene.ism.ssao
    set_by_hand = {}
    for radius, intensity in ((0.1, 1.0), (2.0, 1.0), (2.0, 3.0)):
        ssao.radius, ssao.intensity = radius, intensity
        yield from session.until_idle()
        picture = session.pixels(f"by hand, {radius} and {intensity}")
        assert all(rmse(picture, other) > 0.01 for other in set_by_hand.values()), "there is nothing to be seen"
        set_by_hand[radius, intensity] = picture
    for frame, ssao.radius in ((1, 0.1), (10, 2.0)):
        ssao.keyframe_insert("radius", frame=frame)
    ssao.intensity = 1.0
    for frame, radius in ((1, 0.1), (10, 2.0), (1, 0.1)):
        yield from _frame(session, f"keyframes, {frame}", frame, set_by_hand[radius, 1.0])
    ssao.driver_add("intensity").driver.expression = "1 if frame <= 10 else 3"
    for frame, radius, intensity in ((11, 2.0, 3.0), (10, 2.0, 1.0), (1, 0.1, 1.0)):
        yield from _frame(session, f"driver, {frame}", frame, set_by_hand[radius, intensity])


def _frame(session: Session, name: str, frame: int, expected: np.ndarray) -> Steps:
    session.scene.frame_set(frame)
    yield from session.until_idle()
    session.measured(f"{name}, RMSE", 255 * rmse(session.pixels(name), expected), "/255", must=1, aim=0)


@scenario(region=(600, 420))
def preview_icons(session: Session) -> Steps:
    """The preview icons of a material, a light and a world are drawn by our engine."""
    yield from _settle(session)
    lamp, world = bpy.data.lights["Lamp"], session.scene.world
    lamp.energy, lamp.color = 2.0, (1.0, 0.2, 0.05)
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.05, 0.2, 0.7, 1.0)
    green = scene_setup.material("Green", (0.05, 0.7, 0.1))
    for thing, brightest in ((green, 1), (lamp, 0), (world, 2)):
        preview = thing.preview_ensure()
        with session.in_viewport():
            thing.asset_generate_preview()
        yield from session.until(lambda preview=preview: any(preview.image_pixels), 30, f"a preview of {thing.name}")
        yield from session.until(lambda: not bpy.app.is_job_running("RENDER_PREVIEW"), 30, "the preview is done")
        width, height = preview.image_size
        pixels = np.array(preview.image_pixels_float).reshape(height, width, 4)
        middle = pixels[height // 2, width // 2, :3]
        others = np.delete(middle, brightest).max()
        assert middle[brightest] > 0.2 + others, f"the preview of {thing.name} is {middle} in the middle"


def _settle(session: Session) -> Steps:
    scene_setup.studio()
    session.scene.view_settings.view_transform = "Standard"
    yield from session.until_drawn()
