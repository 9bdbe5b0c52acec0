# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of a viewport: resolution, lens and clipping, overlays, colour management, film, the window's scale.

Our picture's position is tested against Blender's Solid shading of the same view: both show black objects on white.
"""

from collections.abc import Callable

import bpy
import numpy as np

from tests.gui import blank_engine, engine, final, scene_setup
from tests.gui.scenario import scenario
from tests.gui.screenshots import WITHOUT_BORDER, different_pixels, read_png, rmse
from tests.gui.session import Session, Steps

#: Different pixels that are no error: those of lines over silhouettes, whose edges Blender smooths differently.
MAX_DIFFERENT_PIXELS = 10


@scenario(region=(1001, 703), any_size=False)
def resolution(session: Session) -> Steps:
    """At 50 % and 25 % the picture is the same in coarser pixels; back at 100 % it is the first picture."""
    scene_setup.build_studio()
    scene_setup.set_view(session.view)
    session.hide_overlays()
    session.scene.ism.viewport.samples = 4
    session.show_rendered()
    yield from session.until_idle()
    first = session.pixels("100")
    max_slope = np.abs(np.diff(first[WITHOUT_BORDER], axis=1)).max()
    for percent, pixel_size in {"50": 2, "25": 4}.items():
        session.scene.ism.viewport.resolution = percent
        yield from session.until_idle()
        coarse = session.pixels(percent)
        session.record(f"{percent} %, RMSE", 255 * rmse(first, coarse), "/255", must=4)
        slope = np.abs(np.diff(coarse[WITHOUT_BORDER], axis=1)).max() / max_slope
        session.record(f"{percent} %: steepest edge over that of 100 %", slope, must=1.1 / pixel_size)
    session.scene.ism.viewport.resolution = "100"
    yield from session.until_idle()
    session.record("100 % again, RMSE", 255 * rmse(first, session.pixels("100 again")), "/255", must=1)


def _toggle_orthographic(session: Session) -> None:
    with session.in_viewport():
        bpy.ops.view3d.view_persportho()


def _view_from_above(session: Session) -> None:
    with session.in_viewport():
        bpy.ops.view3d.view_axis(type="TOP")


def _view_through_camera(session: Session) -> None:
    camera = scene_setup.add_camera().data
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
    "orthographic": _toggle_orthographic,
    "clip end, orthographic": lambda session: setattr(session.space, "clip_end", 0.4),
    "from above": _view_from_above,
    "shifted camera": _view_through_camera,
    "clipped camera": _clip_camera,
}


@scenario(region=(600, 420))
def lens_and_clip(session: Session) -> Steps:
    """Lens, clipping and projection of a viewport and a camera: objects are where Solid shading draws them."""
    scene_setup.build_silhouettes()
    scene_setup.set_view(session.view)
    session.hide_overlays()
    last = None
    for name, change in VIEWS.items():
        change(session)
        shown = yield from _assert_silhouettes(session, name)
        assert last is None or rmse(shown, last) > 0.03, f"{name}: the picture has not changed"
        last = shown


@scenario(region=(600, 420))
def two_views(session: Session) -> Steps:
    """Two viewports with different lenses and directions."""
    scene_setup.build_silhouettes()
    scene_setup.set_view(session.view)
    session.hide_overlays()
    with session.in_viewport():
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.4)
    yield from session.main_loop()
    session.space.lens = 30.0
    _view_from_above(session)
    yield from _assert_silhouettes(session, "two views")


@scenario(region=(600, 420))
def overlays(session: Session) -> Steps:
    """Overlays and gizmos are as in Solid shading: occluded by nearer objects, and drawn over all else."""
    scene_setup.build_silhouettes()
    scene_setup.set_view(session.view)
    session.hide_overlays()
    ball = bpy.data.objects["Ball"]
    ball.location = (-1.2, 1.4, 0.5)  # half of it is behind the cube
    ball.show_wire = True
    ball.select_set(True)
    session.view_layer.objects.active = ball
    scene_setup.add_object("Axes", None, (-0.9, 0.9, 0.2))
    overlay = session.space.overlay
    overlay.show_text = overlay.show_cursor = session.space.show_gizmo_navigate = False
    with session.in_viewport():
        bpy.ops.wm.tool_set_by_id(name="builtin.move")
    overlay.show_overlays = session.space.show_gizmo = True
    yield from _assert_silhouettes(session, "overlays")


@scenario(region=(600, 420))
def passepartout(session: Session) -> Steps:
    """A camera's passepartout covers the picture outside its frame."""
    scene_setup.build_silhouettes()
    session.hide_overlays()
    _view_through_camera(session)
    session.scene.camera.data.passepartout_alpha = 1.0
    session.space.overlay.show_overlays = True
    session.space.overlay.show_text = session.space.overlay.show_floor = False
    session.space.overlay.show_axis_x = session.space.overlay.show_axis_y = False
    yield from _assert_silhouettes(session, "passepartout")


#: Changes of the scene's view settings, made one after the other.
VIEW_SETTINGS: dict[str, dict] = {
    "Standard": {"view_transform": "Standard"},
    "exposure": {"exposure": 1.5},
    "gamma": {"exposure": 0.0, "gamma": 1.6},
    "AgX": {"view_transform": "AgX", "gamma": 1.0},
    "look": {"look": "AgX - Punchy"},
    "curves": {"look": "None", "use_curve_mapping": True},
}


@scenario(region=(600, 420))
def colour_management(session: Session) -> Steps:
    """View transform, exposure, gamma, look and curves change the picture as they change F12's, without rendering."""
    scene_setup.build_studio()
    scene_setup.set_world(0.9)
    for name, color in {"Cube": (0.8, 0.2, 0.05), "Ball": (0.1, 0.3, 0.7)}.items():
        bpy.data.objects[name].data.materials.append(scene_setup.new_material(name, color))
    scene_setup.add_camera()
    session.hide_overlays()
    session.scene.ism.viewport.samples = 4
    session.scene.view_settings.curve_mapping.curves[3].points.new(0.5, 0.8)
    session.scene.view_settings.curve_mapping.update()
    session.show_rendered()
    yield from session.main_loop()
    final.look_through_camera(session)
    yield from session.until_idle()
    final.render(session, session.folder / "final.png")
    jobs = engine.jobs()
    last = session.pixels("first")
    for name, values in VIEW_SETTINGS.items():
        for key, value in values.items():
            setattr(session.scene.view_settings, key, value)
        yield from session.wait(0.3)
        shown = session.pixels(name)
        path = session.folder / f"{name}, final.png"
        bpy.data.images["Render Result"].save_render(str(path), scene=session.scene)
        difference = rmse(shown[WITHOUT_BORDER], read_png(path)[WITHOUT_BORDER])
        session.record(f"{name}: viewport against F12, RMSE", 255 * difference, "/255", must=1, aim=0)
        assert rmse(shown, last) > 0.03, f"{name}: the picture has not changed"
        assert engine.jobs() == jobs, f"{name}: the picture was rendered again"
        last = shown


@scenario(region=(600, 420))
def film(session: Session) -> Steps:
    """Behind the objects is the world's colour; with a transparent film, the background of Blender's viewport."""
    scene_setup.build_silhouettes()
    scene_setup.set_view(session.view)
    color = np.array([0.4, 0.2, 0.05])
    session.scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1.0)
    session.hide_overlays()
    session.show_rendered()
    yield from session.until_idle()
    opaque = session.pixels("opaque")
    world = 1.055 * color ** (1.0 / 2.4) - 0.055  # as Standard shows it
    background = np.abs(opaque - world).max(axis=-1) < 1.5 / 255
    assert 0.5 < background.mean() < 0.95, "the background is not the world's colour"
    session.scene.render.film_transparent = True
    yield from session.until_idle()
    transparent = session.pixels("transparent")
    with blank_engine.registered() as name:
        session.scene.render.engine = name
        yield from session.wait(0.3)
        empty = session.pixels("empty")
        session.scene.render.engine = "ISM"
        yield from session.main_loop()
    session.record("behind them, RMSE", 255 * rmse(transparent[background], empty[background]), "/255", must=1, aim=0)
    black = opaque.max(axis=-1) == 0.0
    session.record("the objects, RMSE", 255 * rmse(transparent[black], opaque[black]), "/255", must=1, aim=0)


@scenario(region=(1000, 700), alone=True)
def scale_of_the_window(session: Session) -> Steps:
    """The picture fills its region, with panels beside it or over it, and with twice the window's resolution scale."""
    scene_setup.build_silhouettes()
    scene_setup.set_view(session.view)
    preferences = bpy.context.preferences
    session.hide_overlays()
    session.space.show_region_toolbar = session.space.show_region_ui = True
    for overlap in (False, True):
        preferences.system.use_region_overlap = overlap
        yield from _assert_silhouettes(session, f"overlap {overlap}")
    preferences.view.ui_scale = 2.0
    yield from _assert_silhouettes(session, "twice the scale")


def _assert_silhouettes(session: Session, name: str) -> Steps:
    """Silhouettes in all viewports are those of Blender's Solid shading: our picture in the first viewport."""
    session.scene.ism.viewport.samples = 4
    session.show_rendered()
    yield from session.until_idle()
    ours = [session.pixels_of_area(f"{name} {i}, ours", area) for i, area in enumerate(session.areas)]
    session.show_solid()
    yield from session.wait(0.3)
    solid = [session.pixels_of_area(f"{name} {i}, Blender's", area) for i, area in enumerate(session.areas)]
    session.record(f"{name}: pixels astray", sum(map(different_pixels, ours, solid)), must=MAX_DIFFERENT_PIXELS)
    return ours[0]
