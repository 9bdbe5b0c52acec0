# SPDX-License-Identifier: GPL-3.0-or-later
"""A render that is cancelled at any point ends soon, with the picture so far."""

import time

import bpy
import mathutils
import numpy as np
import pytest

from ism_addon import addon
from ism_addon.blender import engine
from ism_addon.blender.render import final_render
from ism_addon.blender.sync.geometry import instances
from ism_addon.gpu import graph, renderer
from ism_addon.gpu.estimators import Occlusion, RayTracedDirect, SeenWorld
from ism_addon.gpu.jobs.job import Request
from tests.scenes.small import box_over_plane
from tests.support import exr
from tests.support.jobs import LONG, wait_for_picture
from tests.tools.new_file import open_factory_file

pytestmark = pytest.mark.alone

#: Passes that are left out here: Resolve waits for more samples, and there is no emission by nodes to bake.
LEFT_OUT = {renderer.Resolve, *renderer.BAKES}
#: Passes of each ray-traced sample.
PASS_TYPES = {*renderer.COMMON, *RayTracedDirect.pass_types, *Occlusion.pass_types, *SeenWorld.pass_types} - LEFT_OUT
PASS_NAMES = sorted(pass_type.__name__ for pass_type in PASS_TYPES)

#: s from the key press until the render has ended.
MAX_DELAY = 0.3


class CancellableEngine(bpy.types.RenderEngine):
    """Delegates to our engine; `press` simulates the Escape key, which a subclass of ours could not."""

    bl_idname = "ISM_CANCELLED"
    bl_label = "ISM, cancelled"
    pressed_at = float("inf")
    ended_at = 0.0

    @classmethod
    def press(cls) -> None:
        cls.pressed_at = min(cls.pressed_at, time.monotonic())

    def update_render_passes(self, scene, layer):
        engine.ISMRenderEngine.update_render_passes(self, scene, layer)

    def render(self, depsgraph):
        final_render.render(EngineWithEscape(self), depsgraph)
        CancellableEngine.ended_at = time.monotonic()


class EngineWithEscape:
    """An engine whose test_break() reports the simulated Escape key."""

    def __init__(self, engine: bpy.types.RenderEngine):
        self.engine = engine

    def __getattr__(self, name):
        return getattr(self.engine, name)

    def test_break(self) -> bool:
        return CancellableEngine.pressed_at < float("inf")


@pytest.fixture
def render_cancelled(tmp_path):
    """render_cancelled(): renders until Escape is pressed; the picture, and the delay of its end in s."""
    open_factory_file()
    addon.register()
    bpy.utils.register_class(CancellableEngine)
    CancellableEngine.pressed_at = float("inf")
    scene = bpy.context.scene
    bpy.data.lights[0].type = "AREA"
    scene.render.engine, scene.render.filepath = CancellableEngine.bl_idname, str(tmp_path / "picture.exr")
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth, scene.render.image_settings.exr_codec = "32", "NONE"
    scene.render.resolution_x, scene.render.resolution_y = 320, 180
    scene.ism.render.samples, scene.ism.render.error_threshold = 65536, 0.0

    def render_cancelled() -> tuple[np.ndarray, float]:
        bpy.ops.render.render(write_still=True)
        channels = exr.read(tmp_path / "picture.exr")
        assert CancellableEngine.pressed_at < float("inf")
        picture = np.stack([channels[name] for name in "RGB"], -1)
        return picture, CancellableEngine.ended_at - CancellableEngine.pressed_at

    yield render_cancelled
    bpy.utils.unregister_class(CancellableEngine)
    addon.unregister()


@pytest.mark.parametrize("sample", [0, 3])
@pytest.mark.parametrize("pass_name", PASS_NAMES)
def test_cancel_in_a_pass(render_cancelled, monkeypatch, assert_within, pass_name, sample):
    """In the first sample, whose shaders are not compiled yet, or in a later one, when there is a picture."""
    step = graph.Graph.step

    def step_and_press(self, pass_type, frame, profile) -> None:
        if pass_type.__name__ == pass_name and frame.sample == sample:
            CancellableEngine.press()
        step(self, pass_type, frame, profile)

    monkeypatch.setattr(graph.Graph, "step", step_and_press)
    picture, delay = render_cancelled()
    assert np.isfinite(picture).all()
    assert picture.any() or sample == 0
    assert_within(delay, MAX_DELAY)


def test_cancel_while_the_scene_is_read(render_cancelled, monkeypatch, assert_within):
    """Escape during the first of a thousand meshes: no further one is read."""
    for _ in range(1000):
        bpy.context.collection.objects.link(bpy.data.objects.new("Cube", bpy.data.meshes["Cube"].copy()))
    read, calls = instances.meshes.read, []

    def read_and_press(*arguments):
        calls.append(arguments)
        CancellableEngine.press()
        return read(*arguments)

    monkeypatch.setattr(instances.meshes, "read", read_and_press)
    picture, delay = render_cancelled()
    assert not picture.any()
    assert len(calls) == 1
    assert_within(delay, MAX_DELAY)
    monkeypatch.undo()
    CancellableEngine.pressed_at = float("inf")
    bpy.context.scene.render.engine, bpy.context.scene.ism.render.samples = "ISM", 1
    bpy.ops.render.render()
    assert engine.statistics()["triangles"] == 12 * 1001


def test_a_change_before_a_cancelled_render_is_read_by_the_next(render_cancelled, monkeypatch):
    """Also with Persistent Data, where Blender reports a change only once."""
    scene, mesh = bpy.context.scene, bpy.data.meshes["Cube"]
    scene.render.use_persistent_data, scene.ism.render.samples = True, 1
    bpy.ops.render.render()
    mesh.transform(mathutils.Matrix.Scale(3.0, 4))
    CancellableEngine.press()
    bpy.ops.render.render()
    CancellableEngine.pressed_at = float("inf")
    scenes = []
    real = final_render.Request
    monkeypatch.setattr(final_render, "Request", lambda scene, *more: scenes.append(scene) or real(scene, *more))
    bpy.ops.render.render()
    assert max(abs(mesh.positions).max() for mesh in scenes[0].meshes) == 3.0


def test_a_viewport_is_drawn_while_its_render_is_cancelled(worker):
    """Jobs of different clients are independent."""
    jobs = [worker.start(Request(*box_over_plane(24, 16), LONG), client) for client in ("viewport", "final")]
    assert all(wait_for_picture(job) for job in jobs)
    jobs[1].cancel()
    before = jobs[0].samples_done
    while jobs[0].samples_done == before:
        jobs[0].wait(1.0)
    assert not jobs[0].finished
