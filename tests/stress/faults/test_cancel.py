# SPDX-License-Identifier: GPL-3.0-or-later
"""Escape, at any stage: it is answered at once, with the picture as far as it came."""

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
from ism_addon.gpu.estimators import RayTracedDirect, WorldLight
from ism_addon.gpu.jobs.job import Request
from tests.scenes.small import box_over_plane
from tests.support import exr
from tests.support.jobs import LONG, wait_for_picture
from tests.tools.new_file import open_factory_file

pytestmark = pytest.mark.alone

#: Passes of each sample by rays. Resolve waits for more samples than are drawn here.
KINDS = {*renderer.COMMON, *RayTracedDirect.pass_types, *WorldLight.pass_types} - {renderer.Resolve}
PASSES = sorted(kind.__name__ for kind in KINDS)

#: s: an answer later than this is none.
SOON = 0.3


class Cancelled(bpy.types.RenderEngine):
    """Ours, whose user presses Escape when `press` says so; a class derived from ours could not be asked that."""

    bl_idname = "ISM_CANCELLED"
    bl_label = "ISM, cancelled"
    pressed = float("inf")
    answered = 0.0

    @classmethod
    def press(cls) -> None:
        cls.pressed = min(cls.pressed, time.monotonic())

    def update_render_passes(self, scene, layer):
        engine.ISMRenderEngine.update_render_passes(self, scene, layer)

    def render(self, depsgraph):
        final_render.render(Watched(self), depsgraph)
        Cancelled.answered = time.monotonic()


class Watched:
    """An engine, but for what its user does."""

    def __init__(self, real: bpy.types.RenderEngine):
        self.real = real

    def __getattr__(self, name):
        return getattr(self.real, name)

    def test_break(self) -> bool:
        return Cancelled.pressed < float("inf")


@pytest.fixture
def cancelled(tmp_path):
    """cancelled(): the picture of a render that is cancelled, and how late, s. The worker's thread begins with it."""
    open_factory_file()
    addon.register()
    bpy.utils.register_class(Cancelled)
    Cancelled.pressed = float("inf")
    scene = bpy.context.scene
    bpy.data.lights[0].type = "AREA"
    scene.render.engine, scene.render.filepath = Cancelled.bl_idname, str(tmp_path / "picture.exr")
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth, scene.render.image_settings.exr_codec = "32", "NONE"
    scene.render.resolution_x, scene.render.resolution_y = 320, 180
    scene.ism.render.samples, scene.ism.render.error_threshold = 65536, 0.0

    def cancelled() -> tuple[np.ndarray, float]:
        bpy.ops.render.render(write_still=True)
        channels = exr.read(tmp_path / "picture.exr")
        assert Cancelled.pressed < float("inf")
        return np.stack([channels[name] for name in "RGB"], -1), Cancelled.answered - Cancelled.pressed

    yield cancelled
    bpy.utils.unregister_class(Cancelled)
    addon.unregister()


@pytest.mark.parametrize("sample", [0, 3])
@pytest.mark.parametrize("stage", PASSES)
def test_cancel_in_a_pass(cancelled, monkeypatch, within, stage, sample):
    """Of the first sample, with its shaders still to be compiled, or of a later one, when there is a picture."""
    step = graph.Graph.step

    def step_and_press(self, kind, frame, profile) -> None:
        if kind.__name__ == stage and frame.sample == sample:
            Cancelled.press()
        step(self, kind, frame, profile)

    monkeypatch.setattr(graph.Graph, "step", step_and_press)
    picture, late = cancelled()
    assert np.isfinite(picture).all()
    assert picture.any() or sample == 0
    within(late, SOON)


def test_cancel_while_the_scene_is_read(cancelled, monkeypatch, within):
    """Of a thousand objects, hardly one is read any more."""
    for _ in range(1000):
        bpy.context.collection.objects.link(bpy.data.objects.new("Cube", bpy.data.meshes["Cube"].copy()))
    read, count = instances.meshes.read, []

    def read_and_press(*arguments):
        count.append(arguments)
        Cancelled.press()
        return read(*arguments)

    monkeypatch.setattr(instances.meshes, "read", read_and_press)
    picture, late = cancelled()
    assert not picture.any()
    assert len(count) == 1
    within(late, SOON)
    monkeypatch.undo()
    Cancelled.pressed = float("inf")
    bpy.context.scene.render.engine, bpy.context.scene.ism.render.samples = "ISM", 1
    bpy.ops.render.render()
    assert engine.statistics()["triangles"] == 12 * 1001


def test_what_changed_before_a_cancelled_reading_is_read_by_the_next(cancelled, monkeypatch):
    """With Persistent Data too, when Blender tells of a change only once."""
    scene, mesh = bpy.context.scene, bpy.data.meshes["Cube"]
    scene.render.use_persistent_data, scene.ism.render.samples = True, 1
    bpy.ops.render.render()
    mesh.transform(mathutils.Matrix.Scale(3.0, 4))
    Cancelled.press()
    bpy.ops.render.render()
    Cancelled.pressed = float("inf")
    read = []
    real = final_render.Request
    monkeypatch.setattr(final_render, "Request", lambda scene, *more: read.append(scene) or real(scene, *more))
    bpy.ops.render.render()
    assert max(abs(mesh.positions).max() for mesh in read[0].meshes) == 3.0


def test_a_viewport_is_drawn_while_its_render_is_cancelled(worker):
    """Clients have nothing to do with one another."""
    jobs = [worker.start(Request(*box_over_plane(24, 16), LONG), client) for client in ("viewport", "final")]
    assert all(wait_for_picture(job) for job in jobs)
    jobs[1].cancel()
    before = jobs[0].samples_done
    while jobs[0].samples_done == before:
        jobs[0].wait(1.0)
    assert not jobs[0].finished
