# SPDX-License-Identifier: GPL-3.0-or-later
"""How a viewport can be set: lens and clip, overlays, size of its pixels, colour management, film, the window's scale.

Where our picture has to lie is seen in Blender's own drawing of the same view: black objects on white in both.
"""

from collections.abc import Callable

import bpy
import numpy as np

from tests.gui import blank, engine, final, scenery
from tests.gui.scenario import scenario
from tests.gui.sight import INSIDE, astray, picture, rmse
from tests.gui.stage import Stage, Steps

#: Pixels of lines over silhouettes, whose edges Blender smooths in its own way.
FEW = 10


@scenario(region=(1001, 703))
def resolution(stage: Stage) -> Steps:
    """Half and a quarter of the resolution show the same in coarser pixels, and all of it the first picture again."""
    scenery.studio()
    scenery.look(stage.view)
    stage.bare()
    stage.scene.ism.viewport.samples = 4
    stage.rendered()
    yield from stage.rested()
    first = stage.pixels("100")
    steepest = np.abs(np.diff(first[INSIDE], axis=1)).max()
    for percent, pixel in {"50": 2, "25": 4}.items():
        stage.scene.ism.viewport.resolution = percent
        yield from stage.rested()
        coarse = stage.pixels(percent)
        stage.measured(f"{percent} %, RMSE", 255 * rmse(first, coarse), "/255", must=4)
        slope = np.abs(np.diff(coarse[INSIDE], axis=1)).max() / steepest
        stage.measured(f"{percent} %: steepest edge over that of 100 %", slope, must=1.1 / pixel)
    stage.scene.ism.viewport.resolution = "100"
    yield from stage.rested()
    stage.measured("100 % again, RMSE", 255 * rmse(first, stage.pixels("100 again")), "/255", must=1)


def _orthographic(stage: Stage) -> None:
    with stage.in_viewport():
        bpy.ops.view3d.view_persportho()


def _from_above(stage: Stage) -> None:
    with stage.in_viewport():
        bpy.ops.view3d.view_axis(type="TOP")


def _through_camera(stage: Stage) -> None:
    camera = scenery.camera().data
    camera.lens, camera.shift_x, camera.shift_y = 35.0, 0.15, -0.1
    stage.view.view_perspective = "CAMERA"
    stage.view.view_camera_zoom, stage.view.view_camera_offset = 10.0, (0.1, -0.05)


def _clip_camera(stage: Stage) -> None:
    camera = stage.scene.camera.data
    camera.type, camera.ortho_scale, camera.clip_start, camera.clip_end = "ORTHO", 5.0, 8.0, 9.0


VIEWS: dict[str, Callable[[Stage], None]] = {
    "wide lens": lambda stage: setattr(stage.space, "lens", 24.0),
    "long lens": lambda stage: setattr(stage.space, "lens", 70.0),
    "clip start": lambda stage: setattr(stage.space, "clip_start", 6.0),
    "clip end": lambda stage: setattr(stage.space, "clip_end", 7.0),
    "orthographic": _orthographic,
    "clip end, orthographic": lambda stage: setattr(stage.space, "clip_end", 0.4),
    "from above": _from_above,
    "shifted camera": _through_camera,
    "clipped camera": _clip_camera,
}


@scenario(region=(600, 420))
def lens_and_clip(stage: Stage) -> Steps:
    """Lens, clip and projection of a viewport and of a camera: objects are where Blender's own drawing has them."""
    scenery.shadow_play()
    scenery.look(stage.view)
    stage.bare()
    last = None
    for name, change in VIEWS.items():
        change(stage)
        seen = yield from _lands(stage, name)
        assert last is None or rmse(seen, last) > 0.03, f"{name}: the picture does not follow"
        last = seen


@scenario(region=(600, 420))
def two_views(stage: Stage) -> Steps:
    """Two viewports, each with a lens and a direction of its own."""
    scenery.shadow_play()
    scenery.look(stage.view)
    stage.bare()
    with stage.in_viewport():
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.4)
    yield from stage.turns()
    stage.space.lens = 30.0
    _from_above(stage)
    yield from _lands(stage, "two views")


@scenario(region=(600, 420))
def overlays(stage: Stage) -> Steps:
    """Overlays and gizmos are as in Blender's own drawing: hidden by what is before them, and on top of all else."""
    scenery.shadow_play()
    scenery.look(stage.view)
    stage.bare()
    ball = bpy.data.objects["Ball"]
    ball.location = (-1.2, 1.4, 0.5)  # half of it is behind the cube
    ball.show_wire = True
    ball.select_set(True)
    stage.view_layer.objects.active = ball
    scenery.add("Axes", None, (-0.9, 0.9, 0.2))
    overlay = stage.space.overlay
    overlay.show_text = overlay.show_cursor = stage.space.show_gizmo_navigate = False
    with stage.in_viewport():
        bpy.ops.wm.tool_set_by_id(name="builtin.move")
    overlay.show_overlays = stage.space.show_gizmo = True
    yield from _lands(stage, "overlays")


@scenario(region=(600, 420))
def passepartout(stage: Stage) -> Steps:
    """A camera's passepartout covers what is outside its frame."""
    scenery.shadow_play()
    stage.bare()
    _through_camera(stage)
    stage.scene.camera.data.passepartout_alpha = 1.0
    stage.space.overlay.show_overlays = True
    stage.space.overlay.show_text = stage.space.overlay.show_floor = False
    stage.space.overlay.show_axis_x = stage.space.overlay.show_axis_y = False
    yield from _lands(stage, "passepartout")


#: What is set of the scene's view settings, one after the other.
LOOKS: dict[str, dict] = {
    "Standard": {"view_transform": "Standard"},
    "exposure": {"exposure": 1.5},
    "gamma": {"exposure": 0.0, "gamma": 1.6},
    "AgX": {"view_transform": "AgX", "gamma": 1.0},
    "look": {"look": "AgX - Punchy"},
    "curves": {"look": "None", "use_curve_mapping": True},
}


@scenario(region=(600, 420))
def colour_management(stage: Stage) -> Steps:
    """View transform, exposure, gamma, look and curves change the picture as F12's saved one, and draw nothing anew."""
    scenery.studio()
    scenery.world(0.9)
    for name, color in {"Cube": (0.8, 0.2, 0.05), "Ball": (0.1, 0.3, 0.7)}.items():
        bpy.data.objects[name].data.materials.append(scenery.material(name, color))
    scenery.camera()
    stage.bare()
    stage.scene.ism.viewport.samples = 4
    stage.scene.view_settings.curve_mapping.curves[3].points.new(0.5, 0.8)
    stage.scene.view_settings.curve_mapping.update()
    stage.rendered()
    yield from stage.turns()
    final.through_camera(stage)
    yield from stage.rested()
    final.render(stage, stage.folder / "final.png")
    jobs = engine.jobs()
    last = stage.pixels("first")
    for name, values in LOOKS.items():
        for key, value in values.items():
            setattr(stage.scene.view_settings, key, value)
        yield from stage.wait(0.3)
        seen = stage.pixels(name)
        path = stage.folder / f"{name}, final.png"
        bpy.data.images["Render Result"].save_render(str(path), scene=stage.scene)
        difference = rmse(seen[INSIDE], picture(path)[INSIDE])
        stage.measured(f"{name}: viewport against F12, RMSE", 255 * difference, "/255", must=1, aim=0)
        assert rmse(seen, last) > 0.03, f"{name}: the picture does not follow"
        assert engine.jobs() == jobs, f"{name}: the picture was drawn anew"
        last = seen


@scenario(region=(600, 420))
def film(stage: Stage) -> Steps:
    """Behind the objects is the world's colour; where the film is transparent, what Blender's viewport has there."""
    scenery.shadow_play()
    scenery.look(stage.view)
    color = np.array([0.4, 0.2, 0.05])
    stage.scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1.0)
    stage.bare()
    stage.rendered()
    yield from stage.rested()
    opaque = stage.pixels("opaque")
    world = 1.055 * color ** (1.0 / 2.4) - 0.055  # as Standard shows it
    behind = np.abs(opaque - world).max(axis=-1) < 1.5 / 255
    assert 0.5 < behind.mean() < 0.95, "behind the objects is not the world's colour"
    stage.scene.render.film_transparent = True
    yield from stage.rested()
    transparent = stage.pixels("transparent")
    with blank.engine() as name:
        stage.scene.render.engine = name
        yield from stage.wait(0.3)
        empty = stage.pixels("empty")
        stage.scene.render.engine = "ISM"
        yield from stage.turns()
    stage.measured("behind them, RMSE", 255 * rmse(transparent[behind], empty[behind]), "/255", must=1, aim=0)
    black = opaque.max(axis=-1) == 0.0
    stage.measured("the objects, RMSE", 255 * rmse(transparent[black], opaque[black]), "/255", must=1, aim=0)


@scenario(region=(1000, 700))
def scale_of_the_window(stage: Stage) -> Steps:
    """With a window of twice the scale, and with panels beside the picture or over it, it fills its region."""
    scenery.shadow_play()
    scenery.look(stage.view)
    preferences = bpy.context.preferences
    stage.bare()
    stage.space.show_region_toolbar = stage.space.show_region_ui = True
    for overlap in (False, True):
        preferences.system.use_region_overlap = overlap
        yield from _lands(stage, f"overlap {overlap}")
    preferences.view.ui_scale = 2.0
    yield from _lands(stage, "twice the scale")


def _lands(stage: Stage, name: str) -> Steps:
    """Our silhouettes are Blender's own, in the viewports' whole areas: returns our picture in the first."""
    stage.scene.ism.viewport.samples = 4
    stage.rendered()
    yield from stage.rested()
    ours = [stage.pixels_of_area(f"{name} {i}, ours", area) for i, area in enumerate(stage.areas)]
    stage.solid()
    yield from stage.wait(0.3)
    own = [stage.pixels_of_area(f"{name} {i}, Blender's", area) for i, area in enumerate(stage.areas)]
    stage.measured(f"{name}: pixels astray", sum(map(astray, ours, own)), must=FEW)
    return ours[0]
