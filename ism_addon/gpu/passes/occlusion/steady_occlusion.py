# SPDX-License-Identifier: GPL-3.0-or-later
"""Ambient occlusion of a first picture in a viewport, steady while the view turns.

It is blended with that of the last views, which have noise elsewhere on a surface (as antialiasing does, Karis 2014).
"""

from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np

from ....resources import NORMAL, POSITION, TERMINATOR_OFFSET, TILES
from ....resources.world import AMBIENT_OCCLUSION, STEADY_OCCLUSION, TRACED_OCCLUSION
from ....scene import Change
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl.context import Device
from ...gl.frame_uniforms import clip_from_anchor
from ...gl.render_targets import create
from ...gl.shader_compiler import bind
from ...occlusion import look_of
from ...occlusion.inputs import drawn_target, occlusion_constants

#: Views over which occlusion is blended: with 8, horizons change by more than 1/255 from view to view.
MAX_VIEWS = 16.0
#: The least similarity of what the last view showed.
MIN_WEIGHT = 0.2


@dataclass(frozen=True)
class LastView:
    """What is kept of a view."""

    occlusion: moderngl.Texture
    other: moderngl.Texture  # what the next view draws into: new memory takes long
    position: moderngl.Texture
    clip_from_anchor: np.ndarray
    anchor: np.ndarray
    view: object  # its state
    origin: tuple[Any, ...]


class SteadyOcclusion(Pass):
    """Ambient occlusion blended over the last views."""

    inputs = (
        *(TILES, POSITION, NORMAL, TERMINATOR_OFFSET, AMBIENT_OCCLUSION, TRACED_OCCLUSION),
        *(Change.VIEW, Change.SAMPLE),
    )
    outputs = outputs(STEADY_OCCLUSION)

    def __init__(self, device: Device):
        super().__init__(device)
        self.last: LastView | None = None

    def needed(self, frame: Frame) -> bool:
        return frame.low_latency and frame.sample == 0 and drawn_target(frame) is not None

    def execute(self, frame: Frame) -> None:
        target, origin, last = drawn_target(frame), self.origin_of(frame), self.last
        assert target is not None
        if last is not None and (last.origin != origin or not frame.settings.shortcuts):
            last = None
        gl, view = self.device.gl, frame.states[Change.VIEW]
        if last is None:
            textures = [create(gl, each, frame.size) for each in (STEADY_OCCLUSION, STEADY_OCCLUSION, POSITION)]
        else:
            textures = [last.other, last.occlusion, last.position]
        occlusion, other, position = textures
        constants: dict[str, Any] = {"max_views": MAX_VIEWS, "min_weight": MIN_WEIGHT, **occlusion_constants(target)}
        program = self.tile_program(**constants)
        self.device.overwrite()
        bind(
            program,
            position=frame[POSITION],
            normal=frame[NORMAL],
            base_color=frame[TERMINATOR_OFFSET],
            ambient_occlusion=frame[target],
            has_last=last is not None,
            last_occlusion=frame[target] if last is None else last.occlusion,
            last_position=frame[POSITION] if last is None else last.position,
            **({} if last is None else self.last_uniforms(frame, last, view)),
        )
        draw_tiles(frame, gl.framebuffer([frame[STEADY_OCCLUSION], occlusion]), program)
        gl.copy_framebuffer(gl.framebuffer([position]), gl.framebuffer([frame[POSITION]]))
        matrix = clip_from_anchor(frame.view, frame.anchor)
        self.last = LastView(occlusion, other, position, matrix, frame.anchor, view, origin)

    @staticmethod
    def last_uniforms(frame: Frame, last: LastView, view: object) -> dict[str, Any]:
        """Uniforms that describe where the last view was."""
        return {
            "last_clip_from_anchor": tuple(last.clip_from_anchor.T.ravel()),
            "anchor_change": tuple(frame.anchor - last.anchor),
            "is_same_view": last.view == view,
        }

    @staticmethod
    def origin_of(frame: Frame) -> tuple[Any, ...]:
        """What occlusion depends on, besides the view."""
        changes = Change.MESHES, Change.MATERIALS
        states = (frame.states[each] for each in changes)
        return *states, frame.scene.instances, frame.size, look_of(frame.settings.ssao)
