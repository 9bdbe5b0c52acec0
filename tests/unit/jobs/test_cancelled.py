# SPDX-License-Identifier: GPL-3.0-or-later
"""Cancelling a picture within a pass: it takes effect after at most one draw, and does not affect later pictures."""

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
from ism_addon.gpu.passes.surfaces import draw_instances
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.sampling import point_cloud
from ism_addon.scene import Scene, View, World
from ism_addon.settings import SSAO, Settings
from tests.scenes.small import box_over_plane
from tests.support.jobs import wait_for_end
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw, with_quality
from tests.unit.gl.test_draw_limit import MAX_RAYS, lit_by_many

RAYS = replace(with_quality(SMALL_SETTINGS, samples=3), ssao=SSAO(enabled=True))
BY_MAPS = with_quality(SMALL_SHADOW_MAPS, samples=3, map_size=64, virtual_lights=12)


class Watch:
    """Records the pass being drawn and its rays between checks, and cancels the picture in the pass `cancel_in`."""

    def __init__(self, monkeypatch):
        self.current_pass, self.cancel_in, self.rays = "", "", 0.0
        #: Checks in the pass `cancel_in` that do not cancel yet.
        self.checks_left = 0
        #: By pass, the most rays between two checks.
        self.max_rays: dict[str, float] = {}
        step, before_draw = Graph.step, submission.Submission.before_draw

        def recorded_step(graph, pass_type, frame, profile):
            self.current_pass, self.rays = pass_type.__name__, 0.0
            step(graph, pass_type, frame, profile)

        def recorded_before_draw(own, rays):
            before_draw(own, rays)
            self.rays += rays
            self.max_rays[self.current_pass] = max(self.max_rays.get(self.current_pass, 0.0), self.rays)

        monkeypatch.setattr(Graph, "step", recorded_step)
        monkeypatch.setattr(submission.Submission, "before_draw", recorded_before_draw)

    def cancelled(self) -> bool:
        self.rays = 0.0
        self.checks_left -= self.current_pass == self.cancel_in
        return self.current_pass == self.cancel_in and self.checks_left < 0


@pytest.fixture
def watch(monkeypatch) -> Watch:
    """A Watch of pictures whose passes all have several portions."""
    monkeypatch.setattr(draw_limit, "MAX_RAYS_PER_DRAW", MAX_RAYS)
    monkeypatch.setattr(draw_instances, "TRIANGLES_AT_A_TIME", 10)
    monkeypatch.setattr(point_cloud, "POINTS_AT_A_TIME", 100)
    monkeypatch.setattr(submission, "SHORT_SAMPLE", 0.0)
    return Watch(monkeypatch)


@pytest.mark.parametrize("settings", [RAYS, BY_MAPS], ids=["by rays", "by maps"])
def test_no_more_rays_than_one_draw_may_have_lie_between_two_checks(device, watch, settings):
    scene, view = lit_by_many(64, 40)
    renderer = Renderer(device)
    for sample in range(3):
        list(renderer.sample(scene, view, settings, sample, Profile(), cancelled=watch.cancelled))
    assert len(watch.max_rays) > 5
    assert max(watch.max_rays.values()) <= MAX_RAYS


def moved(scene: Scene, view: View, settings: Settings) -> tuple[Scene, View, Settings]:
    camera = view.view_from_world.copy()
    camera[0, 3] += 0.2
    return scene, replace(view, view_from_world=camera), settings


def brighter(scene: Scene, view: View, settings: Settings) -> tuple[Scene, View, Settings]:
    return replace(scene, world=World.even(2.0 * scene.world.radiance)), view, settings


def set_to(section: str, **changes: object):
    """change(scene, view, settings): the same with other settings."""

    def change(scene: Scene, view: View, settings: Settings) -> tuple[Scene, View, Settings]:
        return scene, view, replace(settings, **{section: replace(getattr(settings, section), **changes)})

    return change


#: Settings, a change of the picture, and a pass in which it is cancelled: one that the change makes draw again.
CANCELLED_PASSES = [
    *(
        (RAYS, moved, name)
        for name in (
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
#: Passes that are drawn again in later samples of the same picture.
LATER_PASSES = [(RAYS, "GBuffer"), (RAYS, "TraceShadows"), (RAYS, "Accumulate"), (RAYS, "Resolve")]
LATER_PASSES += [(BY_MAPS, "SplatMaps"), (BY_MAPS, "GatherLight")]


@pytest.fixture
def cancel(watch):
    """cancel(renderer, pass_name, picture, last): draw up to sample `last`, and cancel it in that pass."""

    def cancel(renderer: Renderer, pass_name: str, picture: tuple, last: int) -> None:
        for sample in range(last):
            list(renderer.sample(*picture, sample, Profile(), cancelled=watch.cancelled))
        watch.cancel_in, watch.checks_left = pass_name, 0
        with pytest.raises(Cancelled):
            list(renderer.sample(*picture, last, Profile(), cancelled=watch.cancelled))
        watch.cancel_in = ""

    return cancel


@pytest.mark.parametrize(
    ("settings", "change", "pass_name"), CANCELLED_PASSES, ids=[name for *_, name in CANCELLED_PASSES]
)
def test_pictures_after_a_cancelled_one_are_those_of_a_new_renderer(device, cancel, settings, change, pass_name):
    """Both the picture drawn before it and the cancelled one."""
    one = *lit_by_many(60, 36), with_quality(settings, samples=1)
    other = change(*one)
    truths = [draw(device, *picture).color for picture in (one, other)]
    assert not np.array_equal(*truths)
    renderer = Renderer(device)
    draw(device, *one, renderer)
    for picture, truth in zip((one, other), truths, strict=True):
        cancel(renderer, pass_name, other, 0)
        assert np.array_equal(draw(device, *picture, renderer).color, truth)
        draw(device, *one, renderer)


@pytest.mark.parametrize(("settings", "pass_name"), LATER_PASSES, ids=[name for _, name in LATER_PASSES])
def test_the_same_picture_after_a_later_sample_was_cancelled(device, cancel, settings, pass_name):
    """By the same renderer, and then by another that has the same context."""
    picture = *lit_by_many(60, 36), with_quality(settings, samples=2)
    renderer, truth = Renderer(device), draw(device, *picture).color
    draw(device, *picture[:2], with_quality(settings, samples=1), renderer)
    cancel(renderer, pass_name, picture, 1)
    assert np.array_equal(draw(device, *picture, renderer).color, truth)


def test_another_method_after_shadow_maps_were_cancelled(device, cancel):
    """Both methods blend, with different blend equations."""
    scene, view = lit_by_many(60, 36)
    truth = draw(device, scene, view, RAYS).color
    cancel(Renderer(device), "SplatMaps", (scene, view, BY_MAPS), 0)
    assert np.array_equal(draw(device, scene, view, RAYS).color, truth)


def test_a_narrow_filter_after_a_wide_one_was_cancelled(device, watch):
    """Both accumulate; the wide filter draws rows in portions, and is cancelled before the last of them."""
    scene, view = lit_by_many(60, 36)
    wide, renderer = replace(view, filter_width=9.0), Renderer(device)
    watch.cancel_in, watch.checks_left = "Accumulate", 1000
    list(renderer.sample(scene, wide, RAYS, 0, Profile(), cancelled=watch.cancelled))
    watch.checks_left = 999 - watch.checks_left
    with pytest.raises(Cancelled):
        list(renderer.sample(scene, replace(wide, filter_width=9.1), RAYS, 0, Profile(), cancelled=watch.cancelled))
    assert np.array_equal(draw(device, scene, view, RAYS, renderer).color, draw(device, scene, view, RAYS).color)


@pytest.mark.parametrize("how", ["cancel", "stop"])
@pytest.mark.parametrize("pass_name", ["SamplePoints", "SelectPoints", "SplatMaps"])
def test_the_largest_settings(worker, device, monkeypatch, pass_name, how):
    """With the largest shadow map settings a pass takes 15 s on two cores. Once cancelled it makes at most one draw.

    The picture is cancelled just after a check, which is the worst case.
    """
    reached, rays_after, checks_after = threading.Event(), [], []
    watch = Watch(monkeypatch)
    before_draw, check_cancelled = submission.Submission.before_draw, submission.Submission.check_cancelled

    def recorded_before_draw(own, rays):
        before_draw(own, rays)
        if reached.is_set():
            rays_after.append(rays)

    def check_and_wait(own):
        if reached.is_set():
            checks_after.append(watch.current_pass)
        check_cancelled(own)
        if watch.current_pass == pass_name and not reached.is_set():
            reached.set()
            until = time.monotonic() + 30.0
            while not job.cancelled and time.monotonic() < until:
                time.sleep(0.001)

    monkeypatch.setattr(submission.Submission, "before_draw", recorded_before_draw)
    monkeypatch.setattr(submission.Submission, "check_cancelled", check_and_wait)
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
    assert checks_after == [pass_name]
    assert sum(rays_after) <= draw_limit.MAX_RAYS_PER_DRAW
    monkeypatch.undo()
    requested = Request(*box_over_plane(48, 32), SMALL_SHADOW_MAPS)
    assert wait_for_end(again := worker.start(requested, "client"))
    assert np.array_equal(
        again.picture().color, draw(device, requested.scene, requested.view, requested.settings).color
    )
