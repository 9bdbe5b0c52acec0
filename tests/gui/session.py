# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scenario acts on: the window and its 3D viewport. Steps that take time are generators, for `yield from`."""

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
SETTLED_SAMPLES = 6  # sampling is repeatable: few samples tell pictures apart, and are soon drawn
DIFFERENT = 0.03  # of a mean colour: more than noise and coarse first pictures do to a patch

TIMES = ("s", "ms")  # units of what depends on the machine, and on what else it does


class Session:
    """Nothing of bpy is kept: a file that is loaded replaces all of it."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.figures: dict[str, dict] = {}
        self.missed: list[str] = []
        self.slow: list[str] = []
        self.calls = EngineCalls(engine.engine_class())

    @property
    def window(self) -> bpy.types.Window:
        return bpy.context.window_manager.windows[0]

    @property
    def areas(self) -> list[bpy.types.Area]:
        """All 3D viewports; the first is where a scenario acts, as long as it does not say otherwise."""
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

    def rendered(self) -> None:
        """Switch the viewports to Rendered shading by our engine."""
        self.scene.render.engine = "ISM"
        for area in self.areas:
            area.spaces.active.shading.type = "RENDERED"

    def solid(self) -> None:
        """Switch the viewports to Blender's own drawing of black objects on white."""
        for area in self.areas:
            shading = area.spaces.active.shading
            shading.type, shading.light = "SOLID", "FLAT"
            shading.color_type, shading.single_color = "SINGLE", (0.0, 0.0, 0.0)
            shading.background_type, shading.background_color = "VIEWPORT", (1.0, 1.0, 1.0)
            shading.show_object_outline = False

    def without_overlays(self) -> None:
        """Nothing in the viewport but the picture."""
        self.space.overlay.show_overlays = self.space.show_gizmo = False
        for part in ("header", "tool_header", "toolbar", "ui"):
            setattr(self.space, f"show_region_{part}", False)

    def in_viewport(self) -> object:
        """Operators inside this with-block act on the 3D viewport."""
        return bpy.context.temp_override(window=self.window, area=self.area, region=self.region)

    def remember(self, name: str) -> None:
        """A step for undo: edits by script make none by themselves."""
        with self.in_viewport():
            bpy.ops.ed.undo_push(message=name)

    def pixel_of(self, point: tuple[float, float, float]) -> tuple[float, float]:
        """Where a point of the world is seen, as parts of the region from below left."""
        across, up = location_3d_to_region_2d(self.region, self.view, Vector(point))
        return across / self.region.width, up / self.region.height

    def measured(self, name: str, value: float, unit: str = "", must: float | None = None, aim: float | None = None):
        """Keep a figure for the report; more than it must be fails the scenario at its end, or is too slow."""
        self.figures[name] = {"value": float(value), "unit": unit, "must": must, "aim": aim}
        if must is not None and value > must:
            kind = self.slow if unit in TIMES else self.missed
            kind.append(f"{name}: {value:.4g} {unit}, must be at most {must:g}")

    def wait(self, seconds: float) -> Steps:
        """Let Blender's main loop run."""
        end = time.perf_counter() + seconds
        while time.perf_counter() < end:
            yield

    def main_loop(self) -> Steps:
        """Let the main loop take in what was changed, and draw."""
        for _ in range(3):
            yield

    def until(self, condition: Callable[[], object], seconds: float, what: str) -> Steps:
        """Let the main loop run until the condition holds. Fails after that many seconds."""
        end = time.perf_counter() + seconds
        while not condition():
            assert time.perf_counter() < end, f"{what}: not after {seconds} s"
            yield
        assert not engine.errors(), f"the engine said {engine.errors()}"

    def until_drawn(self, distance: float = 7.0) -> Steps:
        """Nothing but the picture of the scene's middle, from that many metres, with all of a few samples."""
        self.scene.ism.viewport.samples = SETTLED_SAMPLES
        scene_setup.set_view(self.view, distance)
        self.without_overlays()
        self.rendered()
        yield from self.until_idle()

    def until_idle(self, seconds: float = 60.0) -> Steps:
        """Until the viewport shows the last sample of the scene as it is now."""
        yield from self.main_loop()
        yield from self.until(lambda: not engine.is_busy(), seconds, "the last sample is shown")
        yield from self.main_loop()

    def until_visible(self, act: Callable[[], object], place: tuple[float, float], seconds: float = 30.0) -> Generator:
        """Act, and return how many seconds later the viewport first shows it, in a patch at a place (u, v)."""
        self.calls.place = place
        asked = time.perf_counter()
        self.region.tag_redraw()
        yield from self.until(lambda: self.calls.patch_colors(asked), 10.0, "a redraw that was asked for")
        before = self.calls.patch_colors(asked)[-1].seen
        began = time.perf_counter()
        act()

        def differing() -> list[float]:
            glimpses = self.calls.patch_colors(began)
            return [call.ended for call in glimpses if np.abs(call.seen - before).max() > DIFFERENT]

        yield from self.until(differing, seconds, "a picture that shows the change")
        self.calls.place = None
        return differing()[0] - began

    def pixels(self, name: str) -> np.ndarray:
        """The 3D viewport's (H,W,3) float32 display values from 0 to 1, top row first, cut from a true screenshot."""
        return self._cut(name, self.region)

    def pixels_of_area(self, name: str, area: bpy.types.Area | None = None) -> np.ndarray:
        """The same of a whole area, with all its regions."""
        return self._cut(name, area or self.area)

    def _cut(self, name: str, part: bpy.types.Region | bpy.types.Area) -> np.ndarray:
        whole = screenshots.screenshot(self.folder / f"{name}.png")
        top = len(whole) - part.y - part.height
        return whole[top : top + part.height, part.x : part.x + part.width]
