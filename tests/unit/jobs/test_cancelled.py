# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture that is cancelled within a pass: it is answered after as much as one draw may be, and leaves no trace."""

import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu import submission
from ism_addon.gpu.gl import draw_limit
from ism_addon.gpu.gl.errors import Cancelled
from ism_addon.gpu.graph import Graph
from ism_addon.gpu.jobs.job import Request
from ism_addon.gpu.passes.shadow_maps import point_cloud
from ism_addon.gpu.passes.surfaces import visibility_buffer
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import Scene, View, World
from ism_addon.settings import SSAO, Settings
from tests.scenes.small import box_over_plane
from tests.support.jobs import wait_for_end
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw, with_quality
from tests.unit.gl.test_draw_limit import FEW, lit_by_many

RAYS = replace(with_quality(SMALL_SETTINGS, samples=3), ssao=SSAO(enabled=True))
BY_MAPS = with_quality(SMALL_SHADOW_MAPS, samples=3, map_size=64, virtual_lights=12)


class Watch:
    """What a renderer is at, and whether somebody has cancelled its picture since it is at some pass."""

    def __init__(self, monkeypatch):
        self.now, self.stage, self.asked = "", "", 0.0
        #: In that pass, how many looks find nothing.
        self.in_vain = 0
        self.most: dict[str, float] = {}
        step, ask = Graph.step, submission.Submission.before_draw

        def step_and_say(graph, kind, frame, profile):
            self.now, self.asked = kind.__name__, 0.0
            step(graph, kind, frame, profile)

        def ask_and_note(its_pace, rays):
            ask(its_pace, rays)
            self.asked += rays
            self.most[self.now] = max(self.most.get(self.now, 0.0), self.asked)

        monkeypatch.setattr(Graph, "step", step_and_say)
        monkeypatch.setattr(submission.Submission, "before_draw", ask_and_note)

    def cancelled(self) -> bool:
        self.asked = 0.0
        self.in_vain -= self.now == self.stage
        return self.now == self.stage and self.in_vain < 0


@pytest.fixture
def watch(monkeypatch) -> Watch:
    """Of pictures whose passes all are long."""
    monkeypatch.setattr(draw_limit, "MAX_RAYS_PER_DRAW", FEW)
    monkeypatch.setattr(visibility_buffer, "TRIANGLES_AT_A_TIME", 10)
    monkeypatch.setattr(point_cloud, "POINTS_AT_A_TIME", 100)
    monkeypatch.setattr(submission, "SHORT_SAMPLE", 0.0)
    return Watch(monkeypatch)


@pytest.mark.parametrize("settings", [RAYS, BY_MAPS], ids=["by rays", "by maps"])
def test_no_more_than_a_draw_may_be_is_asked_for_between_two_looks(device, watch, settings):
    scene, view = lit_by_many(64, 40)
    renderer = Renderer(device)
    for sample in range(3):
        list(renderer.sample(scene, view, settings, sample, Profile(), cancelled=watch.cancelled))
    assert len(watch.most) > 5
    assert max(watch.most.values()) <= FEW


def moved(scene: Scene, view: View, settings: Settings) -> tuple[Scene, View, Settings]:
    camera = view.view_from_world.copy()
    camera[0, 3] += 0.2
    return scene, replace(view, view_from_world=camera), settings


def brighter(scene: Scene, view: View, settings: Settings) -> tuple[Scene, View, Settings]:
    return replace(scene, world=World(2.0 * scene.world.radiance)), view, settings


def set_to(section: str, **changes: object):
    """The same with other settings."""

    def change(scene: Scene, view: View, settings: Settings) -> tuple[Scene, View, Settings]:
        return scene, view, replace(settings, **{section: replace(getattr(settings, section), **changes)})

    return change


#: Of each method, passes, and what is different where they are the first that are drawn again.
STAGES = [
    *(
        (RAYS, moved, stage)
        for stage in (
            "GBuffer",
            "CullLights",
            "ProbeVisibility",
            "PredictVisibility",
            "TraceShadows",
            "BlurOcclusion",
            "Accumulate",
        )
    ),
    (RAYS, set_to("ssao", radius=0.3), "AmbientOcclusion"),
    (RAYS, brighter, "Shade"),
    (BY_MAPS, set_to("quality", map_points=1500), "SamplePoints"),
    (BY_MAPS, set_to("shadow", splat_size=2.0), "SelectPoints"),
    (BY_MAPS, set_to("quality", map_size=56), "SplatMaps"),
    (BY_MAPS, set_to("shadow", fill_threshold=0.5), "FillHoles"),
    (BY_MAPS, set_to("shadow", bias=3.0), "GatherLight"),
]
#: Passes that draw later samples too, of the same picture.
LATER = [(RAYS, "GBuffer"), (RAYS, "TraceShadows"), (RAYS, "Accumulate"), (RAYS, "Resolve")]
LATER += [(BY_MAPS, "SplatMaps"), (BY_MAPS, "GatherLight")]


@pytest.fixture
def cancel(watch):
    """cancel(renderer, stage, picture, sample): at a pass of that sample."""

    def cancel(renderer: Renderer, stage: str, picture: tuple, last: int) -> None:
        for sample in range(last):
            list(renderer.sample(*picture, sample, Profile(), cancelled=watch.cancelled))
        watch.stage, watch.in_vain = stage, 0
        with pytest.raises(Cancelled):
            list(renderer.sample(*picture, last, Profile(), cancelled=watch.cancelled))
        watch.stage = ""

    return cancel


@pytest.mark.parametrize(("settings", "change", "stage"), STAGES, ids=[stage for *_, stage in STAGES])
def test_pictures_after_another_that_was_cancelled_are_those_of_a_new_renderer(device, cancel, settings, change, stage):
    """The one before, and the one that was cancelled."""
    one = *lit_by_many(60, 36), with_quality(settings, samples=1)
    other = change(*one)
    truths = [draw(device, *picture).color for picture in (one, other)]
    assert not np.array_equal(*truths)
    renderer = Renderer(device)
    draw(device, *one, renderer)
    for picture, truth in zip((one, other), truths, strict=True):
        cancel(renderer, stage, other, 0)
        assert np.array_equal(draw(device, *picture, renderer).color, truth)
        draw(device, *one, renderer)


@pytest.mark.parametrize(("settings", "stage"), LATER, ids=[stage for _, stage in LATER])
def test_the_same_picture_after_a_later_sample_was_cancelled(device, cancel, settings, stage):
    """By the same renderer, and then by another that has the same context."""
    picture = *lit_by_many(60, 36), with_quality(settings, samples=2)
    renderer, truth = Renderer(device), draw(device, *picture).color
    draw(device, *picture[:2], with_quality(settings, samples=1), renderer)
    cancel(renderer, stage, picture, 1)
    assert np.array_equal(draw(device, *picture, renderer).color, truth)


def test_another_method_after_shadow_maps_were_cancelled(device, cancel):
    """Both blend, and not by the same equation."""
    scene, view = lit_by_many(60, 36)
    truth = draw(device, scene, view, RAYS).color
    cancel(Renderer(device), "SplatMaps", (scene, view, BY_MAPS), 0)
    assert np.array_equal(draw(device, scene, view, RAYS).color, truth)


def test_a_narrow_filter_after_a_wide_one_was_cancelled(device, watch):
    """Both draw the sums, one portion by portion of the picture's rows: at the last of them it was cancelled."""
    scene, view = lit_by_many(60, 36)
    wide, renderer = replace(view, filter_width=9.0), Renderer(device)
    watch.stage, watch.in_vain = "Accumulate", 1000
    list(renderer.sample(scene, wide, RAYS, 0, Profile(), cancelled=watch.cancelled))
    watch.in_vain = 999 - watch.in_vain
    with pytest.raises(Cancelled):
        list(renderer.sample(scene, replace(wide, filter_width=9.1), RAYS, 0, Profile(), cancelled=watch.cancelled))
    assert np.array_equal(draw(device, scene, view, RAYS, renderer).color, draw(device, scene, view, RAYS).color)


@pytest.mark.parametrize("how", ["cancel", "stop"])
@pytest.mark.parametrize("stage", ["SamplePoints", "SelectPoints", "SplatMaps"])
def test_the_largest_settings(worker, device, monkeypatch, stage, how):
    """Of shadow maps, of which one pass takes 15 s on two cores: it asks for no more than one draw from then on.

    Whoever cancels it does so when it has just been looked whether anybody did.
    """
    reached, asked_after, looks_after = threading.Event(), [], []
    watch = Watch(monkeypatch)
    ask, look = submission.Submission.before_draw, submission.Submission.check_cancelled

    def ask_and_note(its_pace, rays):
        ask(its_pace, rays)
        if reached.is_set():
            asked_after.append(rays)

    def look_and_wait(its_pace):
        if reached.is_set():
            looks_after.append(watch.now)
        look(its_pace)
        if watch.now == stage and not reached.is_set():
            reached.set()
            until = time.monotonic() + 30.0
            while not job.cancelled and time.monotonic() < until:
                time.sleep(0.001)

    monkeypatch.setattr(submission.Submission, "before_draw", ask_and_note)
    monkeypatch.setattr(submission.Submission, "check_cancelled", look_and_wait)
    settings = with_quality(SMALL_SHADOW_MAPS, virtual_lights=4096, map_size=1024, map_points=1 << 20)
    job = worker.start(Request(*box_over_plane(320, 180), settings), "client")
    (thread,) = (each for each in threading.enumerate() if each.name == "ISM renderer")
    assert reached.wait(60.0)
    job.cancel() if how == "cancel" else worker.stop()
    if how == "stop":
        thread.join(30.0)
        assert not thread.is_alive()
    assert wait_for_end(job)
    assert (job.error, job.picture()) == ("", None)
    assert looks_after == [stage]
    assert sum(asked_after) <= draw_limit.MAX_RAYS_PER_DRAW
    monkeypatch.undo()
    asked = Request(*box_over_plane(48, 32), SMALL_SHADOW_MAPS)
    assert wait_for_end(again := worker.start(asked, "client"))
    assert np.array_equal(again.picture().color, draw(device, asked.scene, asked.view, asked.settings).color)
