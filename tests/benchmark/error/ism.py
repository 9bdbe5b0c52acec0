# SPDX-License-Identifier: GPL-3.0-or-later
"""Our engine, without Blender's render call: one accumulation yields all of its pictures."""

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

#: Without ambient occlusion, which the reference does not have.
ALL_SAMPLES = Settings(ssao=SSAO(enabled=False), quality=Quality(error_threshold=0.0))
#: The measured settings, by their names in the tables.
VARIANTS = {
    "ISM": ALL_SAMPLES,
    "ISM, shadow maps": replace(ALL_SAMPLES, shadow=Shadow(method=Method.SHADOW_MAPS)),
}
#: Samples drawn before time is measured: they compile shaders and fill buffers.
WARM_UP_SAMPLES = 2


class Ism:
    """Counted: all passes of all samples. Not counted: reading pictures back, and the warm-up samples."""

    def __init__(self, name: str, settings: Settings, device: Device, benchmark_scene: BenchmarkScene, seconds: float):
        self.name = name
        self.settings, self.benchmark_scene, self.seconds = settings, benchmark_scene, seconds
        self.renderer = Renderer(device)
        # The same picture by a slightly different matrix. It is drawn before each measured picture, so that no pass can
        # reuse results in the measured one: passes keep their results of the newest first sample.
        view = benchmark_scene.view
        self.perturbed_view = replace(view, clip_from_view=(1.0 + 1e-6) * view.clip_from_view)

    def start(self) -> dict[str, float]:
        """Upload the scene and compile the shaders."""
        first, *_ = [self._draw(self.perturbed_view, sample) for sample in range(WARM_UP_SAMPLES)]
        return {"reading the scene s": self.benchmark_scene.seconds, "first sample of all s": first}

    def renders(self, round: int) -> Iterator[Render]:
        """A picture at each power of two of samples, and at the end of the time."""
        for sample in range(WARM_UP_SAMPLES):
            self._draw(self.perturbed_view, sample)
        spent, sample, next_picture = 0.0, 0, 1
        while spent < self.seconds:
            spent += self._draw(self.benchmark_scene.view, sample)
            sample += 1
            if sample == next_picture or spent >= self.seconds:
                start = time.perf_counter()  # a picture is resolved once, from its sums
                picture = self.renderer.picture()[..., :3]
                yield Render(sample, spent + time.perf_counter() - start, picture)
                next_picture = 2 * sample

    def close(self) -> None:
        self.renderer.release()

    def _draw(self, view: View, sample: int) -> float:
        """Draw one sample. Returns its seconds."""
        start, profile = time.perf_counter(), Profile()
        for _ in self.renderer.sample(self.benchmark_scene.scene, view, self.settings, sample, profile):
            pass
        return time.perf_counter() - start
