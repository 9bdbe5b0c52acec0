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
    reach, scout, predict = (renderer.passes[kind] for kind in (CullLights, ProbeVisibility, PredictVisibility))
    look, ask, ask_by_blocks = reach.draw, scout.draw, predict.by_blocks
    lights, found = renderer.tables["reach"], renderer.tables["found"]
    kept = {name: getattr(reach, name) for name in ("bounds", "most", "light")}
    arrives = dict(reach.arrives)

    def told_look(frame: Frame) -> None:
        if frame.sample:
            look(frame)
            return
        vars(reach).update(kept, arrives=dict(arrives))
        frame.tables["reach"] = {light: replace(to, seen=to.seen.copy()) for light, to in lights.items()}
        frame.tables["reaching"] = tuple(sorted(lights))

    def told_ask(frame: Frame) -> None:
        there, nowhere = frame.tables["reach"], np.zeros((*frame.blocks[::-1], 2), bool)
        partly = {light: found.get(light, nowhere).all(2) for light in there}
        frame.tables["reach"] = {
            light: replace(to, worth=to.worth & partly[light], seen=np.ones_like(to.seen))
            for light, to in there.items()
        }
        ask(frame)
        frame.tables["reach"] = there

    def told_by_blocks(frame: Frame, rays: dict, apart: int) -> dict[int, np.ndarray]:
        return ask_by_blocks(frame, rays, apart) if frame.sample else {k: v.copy() for k, v in found.items()}

    reach.draw, scout.draw, predict.by_blocks = told_look, told_ask, told_by_blocks
