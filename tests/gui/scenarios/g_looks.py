# SPDX-License-Identifier: GPL-3.0-or-later
"""How a viewport can be set: lens and clip, overlays, size of its pixels, colour management, film, the window's scale.

Where our picture has to lie is seen in Blender's own drawing of the same view: black objects on white in both.
"""

from collections.abc import Callable

import bpy
import numpy as np

from tests.gui import blank_engine, engine, final, scene_setup
from tests.gui.scenario import scenario
from tests.gui.screenshots import WITHOUT_BORDER, different_pixels, picture, rmse
from tests.gui.session import Session, Steps

#: Pixels of lines over silhouettes, whose edges Blender smooths in its own way.
FEW = 10


@scenario(region=(1001, 703))
def resolution(session: Session) -> Steps:
    """Half and a quarter of the resolution show the same in coarser pixels, and all of it the first picture again."""
    scene_setup.studio()
    scene_setup.set_view(session.view)
    session.without_overlays()
    session.scene.ism.viewport.samples = 4
    session.rendered()
    yield from session.until_idle()
    first = session.pixels("100")
    steepest = np.abs(np.diff(first[WITHOUT_BORDER], axis=1)).max()
    for percent, pixel in {"50": 2, "25": 4}.items():
        session.scene.ism.viewport.resolution = percent
        yield from session.until_idle()
        coarse = session.pixels(percent)
        session.measured(f"{percent} %, RMSE", 255 * rmse(first, coarse), "/255", must=4)
        slope = np.abs(np.diff(coarse[WITHOUT_BORDER], axis=1)).max() / steepest
        session.measured(f"{percent} %: steepest edge over that of 100 %", slope, must=1.1 / pixel)
    session.scene.ism.viewport.resolution = "100"
    yield from session.until_idle()
    session.measured("100 % again, RMSE", 255 * rmse(first, session.pixels("100 again")), "/255", must=1)


def _orthographic(session: Session) -> None:
    with session.in_viewport():
        bpy.ops.view3d.view_persportho()


def _from_above(session: Session) -> None:
    with session.in_viewport():
        bpy.ops.view3d.view_axis(type="TOP")


def _through_camera(session: Session) -> None:
    camera = scene_setup.camera().data
    camera.lens, camera.shift_x, camera.shift_y = 35.0, 0.15, -0.1
    session.view.view_perspective = "CAMERA"
    session.view.view_camera_zoom, session.view.view_camera_offset = 10.0, (0.1, -0.05)


def _clip_camera(session: Session) -> None:
    camera = session.scene.camera.data
    camera.type, camera.ortho_scale, camera.clip_start, camera.clip_end = "ORTHO", 5.0, 8.0, 9.0


VIEWS: dict[str, Callable[[Session], None]] = {
    "wide lens": lambda session: setattr(session.space, "lens", 24.0),
    "long lens": lambda session: setattr(session.space, "lens", 70.0),
    "clip start": lambda session: setattr(session.space, "clip_start", 6.0),
    "clip end": lambda session: setattr(session.space, "clip_end", 7.0),
    "orthographic": _orthographic,
    "clip end, orthographic": lambda session: setattr(session.space, "clip_end", 0.4),
    "from above": _from_above,
    "shifted camera": _through_camera,
    "clipped camera": _clip_camera,
}


@scenario(region=(600, 420))
def lens_and_clip(session: Session) -> Steps:
    """Lens, clip and projection of a viewport and of a camera: objects are where Blender's own drawing has them."""
    scene_setup.shadow_play()
    scene_setup.set_view(session.view)
    session.without_overlays()
    last = None
    for name, change in VIEWS.items():
        change(session)
        seen = yield from _lands(session, name)
        assert last is None or rmse(seen, last) > 0.03, f"{name}: the picture does not follow"
        last = seen


@scenario(region=(600, 420))
def two_views(session: Session) -> Steps:
    """Two viewports, each with a lens and a direction of its own."""
    scene_setup.shadow_play()
    scene_setup.set_view(session.view)
    session.without_overlays()
    with session.in_viewport():
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.4)
    yield from session.main_loop()
    session.space.lens = 30.0
    _from_above(session)
    yield from _lands(session, "two views")


@scenario(region=(600, 420))
def overlays(session: Session) -> Steps:
    """Overlays and gizmos are as in Blender's own drawing: hidden by what is before them, and on top of all else."""
    scene_setup.shadow_play()
    scene_setup.set_view(session.view)
    session.without_overlays()
    ball = bpy.data.objects["Ball"]
    ball.location = (-1.2, 1.4, 0.5)  # half of it is behind the cube
    ball.show_wire = True
    ball.select_set(True)
    session.view_layer.objects.active = ball
    scene_setup.add("Axes", None, (-0.9, 0.9, 0.2))
    overlay = session.space.overlay
    overlay.show_text = overlay.show_cursor = session.space.show_gizmo_navigate = False
    with session.in_viewport():
        bpy.ops.wm.tool_set_by_id(name="builtin.move")
    overlay.show_overlays = session.space.show_gizmo = True
    yield from _lands(session, "overlays")


@scenario(region=(600, 420))
def passepartout(session: Session) -> Steps:
    """A camera's passepartout covers what is outside its frame."""
    scene_setup.shadow_play()
    session.without_overlays()
    _through_camera(session)
    session.scene.camera.data.passepartout_alpha = 1.0
    session.space.overlay.show_overlays = True
    session.space.overlay.show_text = session.space.overlay.show_floor = False
    session.space.overlay.show_axis_x = session.space.overlay.show_axis_y = False
    yield from _lands(session, "passepartout")


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
def colour_management(session: Session) -> Steps:
    """View transform, exposure, gamma, look and curves change the picture as F12's saved one, and draw nothing anew."""
    scene_setup.studio()
    scene_setup.world(0.9)
    for name, color in {"Cube": (0.8, 0.2, 0.05), "Ball": (0.1, 0.3, 0.7)}.items():
        bpy.data.objects[name].data.materials.append(scene_setup.material(name, color))
    scene_setup.camera()
    session.without_overlays()
    session.scene.ism.viewport.samples = 4
    session.scene.view_settings.curve_mapping.curves[3].points.new(0.5, 0.8)
    session.scene.view_settings.curve_mapping.update()
    session.rendered()
    yield from session.main_loop()
    final.through_camera(session)
    yield from session.until_idle()
    final.render(session, session.folder / "final.png")
    jobs = engine.jobs()
    last = session.pixels("first")
    for name, values in LOOKS.items():
        for key, value in values.items():
            setattr(session.scene.view_settings, key, value)
        yield from session.wait(0.3)
        seen = session.pixels(name)
        path = session.folder / f"{name}, final.png"
        bpy.data.images["Render Result"].save_render(str(path), scene=session.scene)
        difference = rmse(seen[WITHOUT_BORDER], picture(path)[WITHOUT_BORDER])
        session.measured(f"{name}: viewport against F12, RMSE", 255 * difference, "/255", must=1, aim=0)
        assert rmse(seen, last) > 0.03, f"{name}: the picture does not follow"
        assert engine.jobs() == jobs, f"{name}: the picture was drawn anew"
        last = seen


@scenario(region=(600, 420))
def film(session: Session) -> Steps:
    """Behind the objects is the world's colour; where the film is transparent, what Blender's viewport has there."""
    scene_setup.shadow_play()
    scene_setup.set_view(session.view)
    color = np.array([0.4, 0.2, 0.05])
    session.scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1.0)
    session.without_overlays()
    session.rendered()
    yield from session.until_idle()
    opaque = session.pixels("opaque")
    world = 1.055 * color ** (1.0 / 2.4) - 0.055  # as Standard shows it
    behind = np.abs(opaque - world).max(axis=-1) < 1.5 / 255
    assert 0.5 < behind.mean() < 0.95, "behind the objects is not the world's colour"
    session.scene.render.film_transparent = True
    yield from session.until_idle()
    transparent = session.pixels("transparent")
    with blank_engine.engine() as name:
        session.scene.render.engine = name
        yield from session.wait(0.3)
        empty = session.pixels("empty")
        session.scene.render.engine = "ISM"
        yield from session.main_loop()
    session.measured("behind them, RMSE", 255 * rmse(transparent[behind], empty[behind]), "/255", must=1, aim=0)
    black = opaque.max(axis=-1) == 0.0
    session.measured("the objects, RMSE", 255 * rmse(transparent[black], opaque[black]), "/255", must=1, aim=0)


@scenario(region=(1000, 700))
def scale_of_the_window(session: Session) -> Steps:
    """With a window of twice the scale, and with panels beside the picture or over it, it fills its region."""
    scene_setup.shadow_play()
    scene_setup.set_view(session.view)
    preferences = bpy.context.preferences
    session.without_overlays()
    session.space.show_region_toolbar = session.space.show_region_ui = True
    for overlap in (False, True):
        preferences.system.use_region_overlap = overlap
        yield from _lands(session, f"overlap {overlap}")
    preferences.view.ui_scale = 2.0
    yield from _lands(session, "twice the scale")


def _lands(session: Session, name: str) -> Steps:
    """Our silhouettes are Blender's own, in the viewports' whole areas: returns our picture in the first."""
    session.scene.ism.viewport.samples = 4
    session.rendered()
    yield from session.until_idle()
    ours = [session.pixels_of_area(f"{name} {i}, ours", area) for i, area in enumerate(session.areas)]
    session.solid()
    yield from session.wait(0.3)
    own = [session.pixels_of_area(f"{name} {i}, Blender's", area) for i, area in enumerate(session.areas)]
    session.measured(f"{name}: pixels astray", sum(map(different_pixels, ours, own)), must=FEW)
    return ours[0]
