# SPDX-License-Identifier: GPL-3.0-or-later
"""What skipping could gain if it knew for nothing which blocks see all, nothing or a part of each light.

Once it has drawn many samples, a renderer is told for all pictures after them what it found. CullLights then costs
nothing, ProbeVisibility looks only where a light is seen in part, and PredictVisibility need not ask where that is. No
way to find it is quicker.
"""

from dataclasses import replace

import numpy as np

from ism_addon.gpu.frame import Frame
from ism_addon.gpu.passes.direct.predict_visibility import PredictVisibility
from ism_addon.gpu.passes.light_selection.cull_lights import CullLights
from ism_addon.gpu.passes.light_selection.probe_visibility import ProbeVisibility
from ism_addon.gpu.renderer import Renderer
from ism_addon.resources import CONTRIBUTING_LIGHTS, CULLING_STATE, LIGHT_INFLUENCE, TILE_VISIBILITY

from .error.ism import Ism

#: Samples by which all is found; predictions have just been renewed.
SAMPLES = 65


class Known(Ism):
    """As Ism, but told."""

    def start(self) -> dict[str, float]:
        """Upload, compile, and find all there is."""
        started = super().start()
        for sample in range(SAMPLES):
            self._draw(self.stage.view, sample)
        tell(self.renderer)
        return started


def tell(renderer: Renderer) -> None:
    """What it has found so far, in each first sample from now on."""
    graph = renderer.graph
    cull, probe, predict = (graph.instance(kind) for kind in (CullLights, ProbeVisibility, PredictVisibility))
    execute_cull, execute_probe, rays_of_tiles = cull.execute, probe.execute, predict.rays_of_tiles
    state, influences, visibility = (graph[each] for each in (CULLING_STATE, LIGHT_INFLUENCE, TILE_VISIBILITY))

    def told_cull(frame: Frame) -> None:
        if frame.sample:
            execute_cull(frame)
            return
        frame[CULLING_STATE], frame[LIGHT_INFLUENCE] = state, influences
        frame[CONTRIBUTING_LIGHTS] = tuple(sorted(influences))

    def told_probe(frame: Frame) -> None:
        nowhere = np.zeros((*frame.tiles[::-1], 2), bool)
        partly = {light: visibility.get(light, nowhere).all(2) for light in influences}
        graph[LIGHT_INFLUENCE] = {
            light: replace(
                to, contributes=to.contributes & partly[light], coarse_visibility=np.ones_like(nowhere[..., 0])
            )
            for light, to in influences.items()
        }
        execute_probe(frame)
        graph[LIGHT_INFLUENCE] = influences

    def told_rays(frame: Frame, rays: dict, spacing: int) -> dict[int, np.ndarray]:
        return rays_of_tiles(frame, rays, spacing) if frame.sample else {k: v.copy() for k, v in visibility.items()}

    cull.execute, probe.execute, predict.rays_of_tiles = told_cull, told_probe, told_rays
