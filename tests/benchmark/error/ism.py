# SPDX-License-Identifier: GPL-3.0-or-later
"""Our engine, driven without Blender's render call: one accumulation gives all of its pictures."""

import time
from collections.abc import Iterator
from dataclasses import replace

from ism_addon.gpu.gl.context import Device
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import View
from ism_addon.settings import SSAO, Method, Quality, Settings, Shadow

from .benchmark_scene import BenchmarkScene
from .engines import Render

#: Without ambient occlusion, which the truth does not know.
ALL_SAMPLES = Settings(ssao=SSAO(enabled=False), quality=Quality(error_threshold=0.0))
#: What is measured of ours, by the name that the table gives it.
VARIANTS = {
    "ISM": ALL_SAMPLES,
    "ISM, shadow maps": replace(ALL_SAMPLES, shadow=Shadow(method=Method.SHADOW_MAPS)),
}
#: Samples drawn before the clock runs: shaders are compiled and buffers filled by then.
WARM_UP = 2


class Ism:
    """Counted: every pass of every sample. Not counted: reading pictures back, and the first sample of all."""

    def __init__(self, name: str, settings: Settings, device: Device, stage: BenchmarkScene, seconds: float):
        self.name = name
        self.settings, self.stage, self.seconds = settings, stage, seconds
        self.renderer = Renderer(device)
        # The same picture from a matrix that is not the same, so that nothing made for it serves the counted one, if
        # its first sample is drawn before each of that one's: passes keep what they made for the newest first sample.
        self.beside = replace(stage.view, clip_from_view=(1.0 + 1e-6) * stage.view.clip_from_view)

    def start(self) -> dict[str, float]:
        """Upload and compile."""
        first, *_ = [self._draw(self.beside, sample) for sample in range(WARM_UP)]
        return {"reading the scene s": self.stage.seconds, "first sample of all s": first}

    def shots(self, round: int) -> Iterator[Render]:
        """A picture at each power of two of samples until the time is up."""
        for sample in range(WARM_UP):
            self._draw(self.beside, sample)
        spent, sample, due = 0.0, 0, 1
        while spent < self.seconds:
            spent += self._draw(self.stage.view, sample)
            sample += 1
            if sample == due or spent >= self.seconds:
                start = time.perf_counter()  # a picture needs its sums put together, once
                picture = self.renderer.picture()[..., :3]
                yield Render(sample, spent + time.perf_counter() - start, picture)
                due = 2 * sample

    def close(self) -> None:
        self.renderer.release()

    def _draw(self, view: View, sample: int) -> float:
        """Seconds that one sample took."""
        start, profile = time.perf_counter(), Profile()
        for _ in self.renderer.sample(self.stage.scene, view, self.settings, sample, profile):
            pass
        return time.perf_counter() - start
