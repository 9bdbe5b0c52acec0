# SPDX-License-Identifier: GPL-3.0-or-later
"""Switching to Rendered, the picture that comes, and the peace after it."""

import time
from collections.abc import Generator

from tests.gui import blank, engine, scenery
from tests.gui.heartbeat import Heartbeat
from tests.gui.scenario import scenario
from tests.gui.stage import Stage, Steps


@scenario()
def switch_to_rendered(stage: Stage) -> Steps:
    """Rendered shading shows lit and shadowed surfaces, among Blender's own panels."""
    scenery.studio()
    scenery.look(stage.view)
    yield from stage.turns()
    solid = stage.pixels("solid")
    began = time.perf_counter()
    stage.rendered()
    yield from stage.rested()
    stage.measured("from Solid to the last sample", time.perf_counter() - began, "s")
    rendered = stage.pixels("rendered")
    rows, columns = rendered.shape[:2]
    middle = rendered[rows // 4 : 3 * rows // 4, columns // 4 : 3 * columns // 4].mean(axis=-1)
    assert abs(rendered - solid).mean() > 0.02, "the picture does not differ from Solid shading"
    assert middle.max() > 0.5, "nothing is lit"
    assert middle.max() - middle.min() > 0.3, "there is no shadow"


@scenario()
def rest(stage: Stage) -> Steps:
    """After the last sample nothing is drawn, until something changes."""
    scenery.studio()
    scenery.look(stage.view)
    stage.rendered()
    yield from stage.rested()
    yield from stage.wait(1.0)
    since, processor = time.perf_counter(), time.process_time()
    yield from stage.wait(5.0)
    stage.measured("redraws in 5 s after the last sample", stage.watch.redraws(since), must=0, aim=0)
    stage.measured("processor time in these 5 s", time.process_time() - processor, "s")


@scenario()
def rest_when_good_enough(stage: Stage) -> Steps:
    """Of very many samples no more are drawn than the error asks for; then nothing is."""
    scenery.studio()
    scenery.look(stage.view)
    quality = stage.scene.ism.viewport
    quality.samples, quality.error_threshold = 65536, 0.05
    stage.rendered()
    yield from stage.rested()
    (job,) = engine.jobs()
    stage.measured("samples", job.samples_done)
    assert job.statistics["stopped_by"] == "error"
    assert job.statistics["error"] < 0.05
    since = time.perf_counter()
    yield from stage.wait(2.0)
    stage.measured("redraws in 2 s after the last sample", stage.watch.redraws(since), must=0, aim=0)


@scenario(patience=240)
def main_loop_lives(stage: Stage) -> Steps:
    """While a picture of 10 s is computed, Blender's main loop goes on."""
    scenery.studio()
    scenery.look(stage.view)
    together, _alone = yield from _gaps(stage)
    stage.measured("longest gap of a 100 Hz timer", together, "ms", must=100, aim=40)


@scenario(region=(1280, 720), patience=240)
def main_loop_lives_among_many(stage: Stage) -> Steps:
    """The same with 500,000 triangles, which Blender itself draws too, for the depth of its overlays."""
    scenery.crowd()
    scenery.look(stage.view, 14.0)
    together, alone = yield from _gaps(stage)
    stage.measured("longest gap of a 100 Hz timer", together, "ms")
    stage.measured("what we add to it", together - alone, "ms", must=40)


def _gaps(stage: Stage) -> Generator:
    """The longest gaps of a heartbeat, ms: as a picture is computed for 10 s, and with an engine that does nothing."""
    quality = stage.scene.ism.viewport
    quality.samples, quality.error_threshold = 1, 0.0
    stage.rendered()
    yield from stage.rested()
    quality.samples = 4096
    since = time.perf_counter()
    with Heartbeat() as heartbeat:
        yield from stage.wait(10.0)
    together = 1e3 * heartbeat.longest_gap
    stage.measured("redraws in 10 s", stage.watch.redraws(since))
    stage.measured("longest redraw", 1e3 * stage.watch.longest_redraw(since), "ms", must=30, aim=10)
    assert stage.watch.redraws(since) > 3, "no better picture was shown for 10 s"
    quality.samples = 1
    yield from stage.rested()
    with blank.engine() as name:
        stage.scene.render.engine = name
        yield from stage.wait(3.0)
        with Heartbeat() as heartbeat:
            for _ in range(10):
                stage.region.tag_redraw()
                yield from stage.wait(0.3)
        stage.scene.render.engine = "ISM"
        yield from stage.turns()
    alone = 1e3 * heartbeat.longest_gap
    stage.measured("longest gap with an engine that does nothing", alone, "ms")
    return together, alone
