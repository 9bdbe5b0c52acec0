# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's window and its 3D viewport, on which a scenario acts.

Methods that wait for Blender's main loop are generators, for `yield from`.
"""

import time
from collections.abc import Callable, Generator
from pathlib import Path

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

from . import engine, scene_setup, screenshots
from .engine_calls import EngineCalls

Steps = Generator[None, None, None]
SAMPLES = 6  # sampling is repeatable: few samples tell pictures apart, and are soon drawn
MIN_CHANGE = 0.03  # of the patch's mean colour: more than noise and coarse first pictures change it

TIME_UNITS = ("s", "ms")  # of figures that depend on the machine and its load


class Session:
    """Keeps no reference to Blender's data: loading a file would make it invalid."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.figures: dict[str, dict] = {}
        self.failures: list[str] = []
        self.slow: list[str] = []
        self.calls = EngineCalls(engine.engine_class())

    @property
    def window(self) -> bpy.types.Window:
        return bpy.context.window_manager.windows[0]

    @property
    def areas(self) -> list[bpy.types.Area]:
        """All 3D viewports; scenarios act on the first, if they do not say otherwise."""
        return [area for area in self.window.screen.areas if area.type == "VIEW_3D"]

    @property
    def area(self) -> bpy.types.Area:
        return self.areas[0]

    @property
    def region(self) -> bpy.types.Region:
        return next(region for region in self.area.regions if region.type == "WINDOW")

    @property
    def space(self) -> bpy.types.SpaceView3D:
        return self.area.spaces.active

    @property
    def view(self) -> bpy.types.RegionView3D:
        return self.space.region_3d

    @property
    def scene(self) -> bpy.types.Scene:
        return self.window.scene

    @property
    def view_layer(self) -> bpy.types.ViewLayer:
        return self.window.view_layer

    def show_rendered(self) -> None:
        """Switch the viewports to Rendered shading by our engine."""
        self.scene.render.engine = "ISM"
        for area in self.areas:
            area.spaces.active.shading.type = "RENDERED"

    def show_solid(self) -> None:
        """Switch the viewports to Solid shading: Blender draws black objects on white."""
        for area in self.areas:
            shading = area.spaces.active.shading
            shading.type, shading.light = "SOLID", "FLAT"
            shading.color_type, shading.single_color = "SINGLE", (0.0, 0.0, 0.0)
            shading.background_type, shading.background_color = "VIEWPORT", (1.0, 1.0, 1.0)
            shading.show_object_outline = False

    def hide_overlays(self) -> None:
        """Hide overlays, gizmos and panels, so that the viewport shows nothing but the picture."""
        self.space.overlay.show_overlays = self.space.show_gizmo = False
        for part in ("header", "tool_header", "toolbar", "ui"):
            setattr(self.space, f"show_region_{part}", False)

    def in_viewport(self) -> object:
        """Operators inside this with-block act on the 3D viewport."""
        return bpy.context.temp_override(window=self.window, area=self.area, region=self.region)

    def push_undo(self, name: str) -> None:
        """Add an undo step: edits by script add none by themselves."""
        with self.in_viewport():
            bpy.ops.ed.undo_push(message=name)

    def region_uv(self, point: tuple[float, float, float]) -> tuple[float, float]:
        """(u, v) of a point in world space: 0 to 1 across the region, from its lower left corner."""
        x, y = location_3d_to_region_2d(self.region, self.view, Vector(point))
        return x / self.region.width, y / self.region.height

    def record(self, name: str, value: float, unit: str = "", must: float | None = None, aim: float | None = None):
        """Keep a figure for the report, with its limit (`must`) and its target (`aim`).

        Above the limit, the scenario fails at its end, or is too slow if the figure is a time.
        """
        self.figures[name] = {"value": float(value), "unit": unit, "must": must, "aim": aim}
        if must is not None and value > must:
            messages = self.slow if unit in TIME_UNITS else self.failures
            messages.append(f"{name}: {value:.4g} {unit}, must be at most {must:g}")

    def wait(self, seconds: float) -> Steps:
        """Let Blender's main loop run."""
        end = time.perf_counter() + seconds
        while time.perf_counter() < end:
            yield

    def main_loop(self) -> Steps:
        """Let the main loop evaluate changes and draw."""
        for _ in range(3):
            yield

    def until(self, condition: Callable[[], object], seconds: float, what: str) -> Steps:
        """Let the main loop run until the condition holds. Fails if it does not within that many seconds."""
        end = time.perf_counter() + seconds
        while not condition():
            assert time.perf_counter() < end, f"{what}: not within {seconds} s"
            yield
        assert not engine.errors(), f"errors of the engine: {engine.errors()}"

    def until_drawn(self, distance: float = 7.0) -> Steps:
        """Show nothing but the scene's middle, from that many metres, until all of a few samples are drawn."""
        self.scene.ism.viewport.samples = SAMPLES
        scene_setup.set_view(self.view, distance)
        self.hide_overlays()
        self.show_rendered()
        yield from self.until_idle()

    def until_idle(self, seconds: float = 60.0) -> Steps:
        """Let the main loop run until the viewport shows the last sample of the scene as it is now."""
        yield from self.main_loop()
        yield from self.until(lambda: not engine.is_busy(), seconds, "the last sample is shown")
        yield from self.main_loop()

    def until_visible(self, action: Callable[[], object], uv: tuple[float, float], seconds: float = 30.0) -> Generator:
        """Do something; return the seconds until the viewport shows it, in a patch around (u, v) of the region."""
        self.calls.patch_uv = uv
        requested = time.perf_counter()
        self.region.tag_redraw()
        yield from self.until(lambda: self.calls.patch_colors(requested), 10.0, "the requested redraw")
        before = self.calls.patch_colors(requested)[-1].patch_color
        began = time.perf_counter()
        action()

        def times_of_change() -> list[float]:
            calls = self.calls.patch_colors(began)
            return [call.ended for call in calls if np.abs(call.patch_color - before).max() > MIN_CHANGE]

        yield from self.until(times_of_change, seconds, "a picture that shows the change")
        self.calls.patch_uv = None
        return times_of_change()[0] - began

    def pixels(self, name: str) -> np.ndarray:
        """The 3D viewport's (H,W,3) float32 display values from 0 to 1, top row first, cropped from a screenshot."""
        return self._cropped(name, self.region)

    def pixels_of_area(self, name: str, area: bpy.types.Area | None = None) -> np.ndarray:
        """The same for an area, with all its regions."""
        return self._cropped(name, area or self.area)

    def _cropped(self, name: str, rectangle: bpy.types.Region | bpy.types.Area) -> np.ndarray:
        window = screenshots.screenshot(self.folder / f"{name}.png")
        top = len(window) - rectangle.y - rectangle.height
        return window[top : top + rectangle.height, rectangle.x : rectangle.x + rectangle.width]
