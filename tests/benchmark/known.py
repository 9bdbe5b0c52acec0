# SPDX-License-Identifier: GPL-3.0-or-later
"""A bound of what skipping can save: a renderer that knows each tile's visibility of each light without any cost.

It draws many samples, and then reuses their visibility in all further pictures: CullLights costs nothing,
ProbeVisibility probes only tiles from which a light is partly visible, and PredictVisibility need not find them.
"""

from dataclasses import replace

import numpy as np

from ism_addon.gpu.frame import Frame
from ism_addon.gpu.passes.direct.predict_visibility import PredictVisibility
from ism_addon.gpu.passes.light_selection.cull_lights import CullLights
from ism_addon.gpu.passes.light_selection.probe_visibility import ProbeVisibility
from ism_addon.gpu.renderer import Renderer
from ism_addon.resources import (
    CONTRIBUTING_LIGHTS,
    CULLING_STATE,
    HIDDEN_LIGHTS,
    LIGHT_INFLUENCE,
    REDISCOVERED,
    TILE_VISIBILITY,
)

from .error.ism import Ism

#: Samples after which the visibility is known. Predictions have just been updated at this number.
SAMPLES = 65


class Known(Ism):
    """Ism with known visibility."""

    def start(self) -> dict[str, float]:
        """Upload, compile, and find the visibility."""
        uncounted = super().start()
        for sample in range(SAMPLES):
            self._draw(self.benchmark_scene.view, sample)
        use_known_visibility(self.renderer)
        return uncounted


def use_known_visibility(renderer: Renderer) -> None:
    """Let each first sample from now on use the visibility that the renderer has found so far."""
    graph = renderer.graph
    cull, probe, predict = (graph.instance(pass_type) for pass_type in (CullLights, ProbeVisibility, PredictVisibility))
    execute_cull, execute_probe, rays_of_tiles = cull.execute, probe.execute, predict.rays_of_tiles
    state, influences, visibility = (graph[each] for each in (CULLING_STATE, LIGHT_INFLUENCE, TILE_VISIBILITY))
    hidden = graph[HIDDEN_LIGHTS]

    def known_cull(frame: Frame) -> None:
        if frame.sample:
            execute_cull(frame)
            return
        frame[CULLING_STATE], frame[LIGHT_INFLUENCE], frame[HIDDEN_LIGHTS] = state, influences, hidden
        frame[REDISCOVERED] = {}
        frame[CONTRIBUTING_LIGHTS] = tuple(sorted(influences))

    def known_probe(frame: Frame) -> None:
        none = np.zeros((*frame.tiles[::-1], 2), bool)
        partly = {light: visibility.get(light, none).all(2) for light in influences}
        graph[LIGHT_INFLUENCE] = {
            light: replace(to, contributes=to.contributes & partly[light], coarse_visibility=np.ones_like(none[..., 0]))
            for light, to in influences.items()
        }
        execute_probe(frame)
        graph[LIGHT_INFLUENCE] = influences

    def known_rays(frame: Frame, rays: dict, spacing: int) -> dict[int, np.ndarray]:
        return rays_of_tiles(frame, rays, spacing) if frame.sample else {k: v.copy() for k, v in visibility.items()}

    cull.execute, probe.execute, predict.rays_of_tiles = known_cull, known_probe, known_rays
