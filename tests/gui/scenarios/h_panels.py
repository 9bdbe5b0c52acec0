# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels offer: debug views, shaders anew, snapshots, presets, keyframes and drivers, preview icons."""

import bpy
import numpy as np

from tests.gui import engine, scenery
from tests.gui.scenario import scenario
from tests.gui.sight import INSIDE, rmse
from tests.gui.stage import Stage, Steps

#: Of debug views: what they show at a place of the studio, linear.
TARGETS = {
    "base_color": ((0.0, 0.0, 0.0), (0.8, 0.8, 0.8)),
    "normal": ((-0.9, -0.6, 0.6), (0.5, 0.0, 0.5)),  # on the cube's side to the front
}


@scenario(region=(600, 420))
def debug_views(stage: Stage) -> Steps:
    """A debug view shows a target of a pass, and then the picture again; and so do shaders that are read anew."""
    yield from _settle(stage)
    first = stage.pixels("picture")
    for name, (point, linear) in TARGETS.items():
        stage.scene.ism.debug_view = name
        yield from stage.rested()
        across, up = stage.place_of(point)
        shown = stage.pixels(name)
        texel = shown[round((1.0 - up) * len(shown)), round(across * len(shown[0]))]
        expected = [1.055 * value ** (1.0 / 2.4) - 0.055 if value else 0.0 for value in linear]
        stage.measured(f"{name}: off by", 255 * np.abs(texel - expected).max(), "/255", must=2)
    stage.scene.ism.debug_view = "sample_color"
    yield from stage.rested()
    stage.measured("the picture again, RMSE", 255 * rmse(first, stage.pixels("again")), "/255", must=1, aim=0)
    jobs = engine.jobs()
    with stage.in_viewport():
        bpy.ops.ism.reload_shaders()
    yield from stage.rested()
    assert engine.jobs() != jobs, "the shaders were read anew, and nothing was drawn"
    stage.measured("shaders anew, RMSE", 255 * rmse(first, stage.pixels("shaders anew")), "/255", must=1, aim=0)


@scenario(region=(600, 420))
def saved_snapshot(stage: Stage) -> Steps:
    """A snapshot saved from the viewport, drawn without Blender, is what the viewport shows: in local view too."""
    yield from _settle(stage)
    yield from _snapshot(stage, "all of the scene")
    with stage.in_viewport():
        bpy.data.objects["Cube"].select_set(True)
        bpy.ops.view3d.localview(frame_selected=False)
    yield from _snapshot(stage, "local view")
    with stage.in_viewport():
        bpy.ops.view3d.localview(frame_selected=False)
    bpy.context.preferences.view.ui_scale = 2.0
    yield from _snapshot(stage, "twice the scale of the window")


def _snapshot(stage: Stage, name: str) -> Steps:
    yield from stage.rested()
    path = stage.folder / f"{name}.npz"
    with stage.in_viewport():
        bpy.ops.ism.save_snapshot(filepath=str(path))
    seen, drawn = stage.pixels(f"{name}, seen"), engine.drawn(path)
    stage.measured(f"{name}, RMSE", 255 * rmse(seen[INSIDE], drawn[INSIDE]), "/255", must=1, aim=0)


@scenario(region=(600, 420))
def presets(stage: Stage) -> Steps:
    """A preset sets the quality and is seen; undone, all is as before."""
    yield from _settle(stage)
    stage.scene.ism.viewport.samples = 5  # what no preset has
    yield from stage.rested()
    first = stage.pixels("before")
    stage.remember("Before")
    (folder,) = bpy.utils.preset_paths("ism/quality")
    for name, samples, percent in (("Draft", 4, "50"), ("Final", 64, "100")):
        with stage.in_viewport():
            bpy.ops.script.execute_preset(filepath=f"{folder}/{name}.py", menu_idname="ISM_RENDER_PT_presets")
        assert _quality(stage) == (samples, percent), f"{name} does not set the quality"
        yield from stage.rested()
        changed = np.abs(stage.pixels(name) - first)[INSIDE].max()
        assert changed > 0.1, f"{name} is not seen"
        with stage.in_viewport():
            bpy.ops.ed.undo()
        assert _quality(stage) == (5, "100"), f"{name} cannot be undone"
        yield from stage.rested()
        stage.measured(f"{name} undone, RMSE", 255 * rmse(first, stage.pixels(f"{name} undone")), "/255", must=1, aim=0)


def _quality(stage: Stage) -> tuple[int, str]:
    viewport = stage.scene.ism.viewport
    return viewport.samples, viewport.resolution


@scenario(region=(600, 420))
def animated_settings(stage: Stage) -> Steps:
    """Keyframes and drivers of settings are followed from frame to frame."""
    yield from _settle(stage)
    scenery.world(0.9)
    bpy.data.lights["Lamp"].energy = 10.0
    ssao = stage.scene.ism.ssao
    set_by_hand = {}
    for radius, intensity in ((0.1, 1.0), (2.0, 1.0), (2.0, 3.0)):
        ssao.radius, ssao.intensity = radius, intensity
        yield from stage.rested()
        picture = stage.pixels(f"by hand, {radius} and {intensity}")
        assert all(rmse(picture, other) > 0.01 for other in set_by_hand.values()), "there is nothing to be seen"
        set_by_hand[radius, intensity] = picture
    for frame, ssao.radius in ((1, 0.1), (10, 2.0)):
        ssao.keyframe_insert("radius", frame=frame)
    ssao.intensity = 1.0
    for frame, radius in ((1, 0.1), (10, 2.0), (1, 0.1)):
        yield from _frame(stage, f"keyframes, {frame}", frame, set_by_hand[radius, 1.0])
    ssao.driver_add("intensity").driver.expression = "1 if frame <= 10 else 3"
    for frame, radius, intensity in ((11, 2.0, 3.0), (10, 2.0, 1.0), (1, 0.1, 1.0)):
        yield from _frame(stage, f"driver, {frame}", frame, set_by_hand[radius, intensity])


def _frame(stage: Stage, name: str, frame: int, expected: np.ndarray) -> Steps:
    stage.scene.frame_set(frame)
    yield from stage.rested()
    stage.measured(f"{name}, RMSE", 255 * rmse(stage.pixels(name), expected), "/255", must=1, aim=0)


@scenario(region=(600, 420))
def preview_icons(stage: Stage) -> Steps:
    """The preview icons of a material, a light and a world are drawn by our engine."""
    yield from _settle(stage)
    lamp, world = bpy.data.lights["Lamp"], stage.scene.world
    lamp.energy, lamp.color = 2.0, (1.0, 0.2, 0.05)
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.05, 0.2, 0.7, 1.0)
    green = scenery.material("Green", (0.05, 0.7, 0.1))
    for thing, brightest in ((green, 1), (lamp, 0), (world, 2)):
        preview = thing.preview_ensure()
        with stage.in_viewport():
            thing.asset_generate_preview()
        yield from stage.until(lambda preview=preview: any(preview.image_pixels), 30, f"a preview of {thing.name}")
        yield from stage.until(lambda: not bpy.app.is_job_running("RENDER_PREVIEW"), 30, "the preview is done")
        width, height = preview.image_size
        pixels = np.array(preview.image_pixels_float).reshape(height, width, 4)
        middle = pixels[height // 2, width // 2, :3]
        others = np.delete(middle, brightest).max()
        assert middle[brightest] > 0.2 + others, f"the preview of {thing.name} is {middle} in the middle"


def _settle(stage: Stage) -> Steps:
    scenery.studio()
    stage.scene.view_settings.view_transform = "Standard"
    yield from stage.settled()
