# SPDX-License-Identifier: GPL-3.0-or-later
"""Switching to Rendered shading: the picture, the main loop during rendering, and no redraw after the last sample."""

import time
from collections.abc import Generator

from tests.gui import blank_engine, engine, scene_setup
from tests.gui.heartbeat import Heartbeat
from tests.gui.scenario import scenario
from tests.gui.session import Session, Steps


@scenario()
def switch_to_rendered(session: Session) -> Steps:
    """Rendered shading shows lit and shadowed surfaces, among Blender's own panels."""
    scene_setup.build_studio()
    scene_setup.set_world(0.1, shadows=True)
    scene_setup.set_view(session.view)
    yield from session.main_loop()
    solid = session.pixels("solid")
    began = time.perf_counter()
    session.show_rendered()
    yield from session.until_idle()
    session.record("from Solid to the last sample", time.perf_counter() - began, "s")
    rendered = session.pixels("rendered")
    rows, columns = rendered.shape[:2]
    middle = rendered[rows // 4 : 3 * rows // 4, columns // 4 : 3 * columns // 4].mean(axis=-1)
    assert abs(rendered - solid).mean() > 0.02, "the picture is the same as in Solid shading"
    assert middle.max() > 0.5, "nothing is lit"
    assert middle.max() - middle.min() > 0.3, "there is no shadow"


@scenario()
def rest(session: Session) -> Steps:
    """After the last sample the viewport is not redrawn until something changes."""
    scene_setup.build_studio()
    scene_setup.set_view(session.view)
    session.show_rendered()
    yield from session.main_loop()
    yield from session.until(lambda: not engine.is_rendering(), 60.0, "the last sample is drawn")
    drawn = time.perf_counter()
    yield from session.until_idle()
    session.record("from the last sample to its redraw", time.perf_counter() - drawn, "s", must=0.5, aim=0.1)
    yield from session.wait(1.0)
    since, processor = time.perf_counter(), time.process_time()
    yield from session.wait(5.0)
    session.record("redraws in 5 s after the last sample", session.calls.redraws(since), must=0, aim=0)
    session.record("processor time in these 5 s", time.process_time() - processor, "s")


@scenario()
def rest_when_good_enough(session: Session) -> Steps:
    """Sampling stops at the error threshold, before the number of samples; then the viewport is not redrawn."""
    scene_setup.build_studio()
    scene_setup.set_view(session.view)
    quality = session.scene.ism.viewport
    quality.samples, quality.error_threshold = 65536, 0.05
    session.show_rendered()
    yield from session.until_idle()
    (job,) = engine.jobs()
    session.record("samples", job.samples_done)
    assert job.statistics["stopped_by"] == "error"
    assert job.statistics["error"] < 0.05
    since = time.perf_counter()
    yield from session.wait(2.0)
    session.record("redraws in 2 s after the last sample", session.calls.redraws(since), must=0, aim=0)


@scenario(timeout=240)
def main_loop_lives(session: Session) -> Steps:
    """While the viewport renders for 10 s, Blender's main loop keeps running."""
    scene_setup.build_studio()
    scene_setup.set_view(session.view)
    gap, _ = yield from _longest_gaps(session)
    session.record("longest gap of a 100 Hz timer", gap, "ms", must=100, aim=40)


@scenario(region=(1280, 720), timeout=240)
def main_loop_lives_among_many(session: Session) -> Steps:
    """The same with 500,000 triangles, which Blender draws too, for the depth of its overlays."""
    scene_setup.build_many_balls()
    scene_setup.set_view(session.view, 14.0)
    gap, blank_gap = yield from _longest_gaps(session)
    session.record("longest gap of a 100 Hz timer", gap, "ms")
    session.record("what we add to it", gap - blank_gap, "ms", must=40)


def _longest_gaps(session: Session) -> Generator:
    """The longest gaps of a heartbeat, ms: while our engine renders for 10 s, and with one that does nothing."""
    quality = session.scene.ism.viewport
    quality.samples, quality.error_threshold = 1, 0.0
    session.show_rendered()
    yield from session.until_idle()
    quality.samples = 4096
    since = time.perf_counter()
    with Heartbeat() as heartbeat:
        yield from session.wait(10.0)
    gap = 1e3 * heartbeat.longest_gap
    session.record("redraws in 10 s", session.calls.redraws(since))
    session.record("longest redraw", 1e3 * session.calls.longest_redraw(since), "ms", must=30, aim=10)
    assert session.calls.redraws(since) > 3, "the picture was hardly redrawn in 10 s"
    quality.samples = 1
    yield from session.until_idle()
    with blank_engine.registered() as name:
        session.scene.render.engine = name
        yield from session.wait(3.0)
        with Heartbeat() as heartbeat:
            for _ in range(10):
                session.region.tag_redraw()
                yield from session.wait(0.3)
        session.scene.render.engine = "ISM"
        yield from session.main_loop()
    blank_gap = 1e3 * heartbeat.longest_gap
    session.record("longest gap with an engine that does nothing", blank_gap, "ms")
    return gap, blank_gap
