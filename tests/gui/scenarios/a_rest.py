# SPDX-License-Identifier: GPL-3.0-or-later
"""Switching to Rendered, the picture that comes, and the peace after it."""

import time

from tests.gui import scenery
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


@scenario(region=(1280, 720), patience=180)
def main_loop_lives(stage: Stage) -> Steps:
    """While a picture of 10 s is computed, Blender's main loop goes on."""
    scenery.crowd()
    scenery.look(stage.view, 14.0)
    stage.rendered()
    stage.scene.ism.viewport.samples = 1
    yield from stage.rested()
    stage.scene.ism.viewport.samples = 4096
    yield from stage.turns()
    since = time.perf_counter()
    with Heartbeat() as heartbeat:
        yield from stage.wait(10.0)
    stage.scene.ism.viewport.samples = 1
    stage.measured("longest gap of a 100 Hz timer", 1e3 * heartbeat.longest_gap, "ms", must=100, aim=40)
    stage.measured("longest redraw", 1e3 * stage.watch.longest_redraw(since), "ms", must=30, aim=10)
    stage.measured("redraws in 10 s", stage.watch.redraws(since))
    assert stage.watch.redraws(since) > 3, "no better picture was shown for 10 s"
    yield from stage.rested()
