# SPDX-License-Identifier: GPL-3.0-or-later
"""What the camera sees: first which triangle, then its depth, position, normals and albedo.

A visibility buffer (Burns & Hunt 2013): the triangles are drawn with nothing but their positions and numbers; all else
is fetched once a pixel. Beck-Norén & Valter 2013, section 3.3, store depth, normals and positions likewise.
"""

import math

import moderngl
import numpy as np

from ....scene import Change
from ....setting_limits import TEXTURE_WIDTH
from ...buffers.instance_buffers import MultiDrawCall, portions
from ...frame import BACKGROUND_DEPTH, Frame, Pass
from ...gl.context import Device
from ...gl.depth import logarithm, nearness
from ...gl.frame_uniforms import clip_from_anchor
from ...gl.render_targets import DEPTH, Target
from ...gl.shader_compiler import bind, compile_program
from ...gl.shader_records import INSTANCE, MATERIAL

#: OpenGL cuts triangles off so far beyond the picture, in its sizes: where it cuts a vast one may be off by pixels.
GUARD_BAND = 0.125

#: Triangles handed over at a time: processors draw them on all cores while one reads the next ones, and need not take
#: memory for all of them.
TRIANGLES_AT_A_TIME = 1 << 16


class GBuffer(Pass):
    """Depth along the view's axis, position, normals and albedo of each pixel's nearest surface."""

    writes = {
        "triangles": Target(2, "u4", divisor=0),  # on a finer grid than the pixels'; several samples share it
        "z": Target(1, DEPTH, divisor=0),
        "triangle": Target(2, "u4"),
        "depth": Target(1, "f4", neutral=(BACKGROUND_DEPTH,)),
        "position": Target(4, "f4"),
        "normal": Target(4, "f4"),  # octahedral: shading normal in xy, the triangle's own in zw
        "albedo": Target(4, "f4"),  # in alpha: the rise
    }
    makes = ("rise",)  # how far the curved surface stands out over the triangle
    reads = ("geometry", "placement", "surfaces", "coordinates", "blocks")
    parts = {"surfaces": ("albedo",)}
    settings = ("shortcuts",)
    depends_on = (Change.VIEW, Change.SAMPLE)

    def __init__(self, device: Device):
        super().__init__(device)
        stages = (f"passes/surfaces/visibility_buffer.{stage}" for stage in ("vert", "frag"))
        self.triangles = compile_program(
            device, *stages, records=(INSTANCE,), reversed_depth=int(device.reversed_depth)
        )
        self.drawn: tuple = ()

    def draw(self, frame: Frame) -> None:
        count = len(frame.grid.places)
        drawn = (
            frame.sample // count,
            count,
            frame.part(Change.VIEW),
            frame.tables["geometry"],
            frame.tables["placement"],
        )
        if drawn != self.drawn:
            self.drawn = ()  # until it is done, see Cancelled
            self.draw_triangles(frame)
            self.drawn = drawn
        frame.device.gl.enable_only(moderngl.NOTHING)
        first, size = frame.grid.bounds(frame.view.width, frame.view.height)
        # Without images no shader is ready for them: many processors would walk through that too.
        images = len(frame.scene.images) > 0
        surface = self.tile_program(
            INSTANCE, MATERIAL, background_depth=BACKGROUND_DEPTH, images=int(images), width=TEXTURE_WIDTH
        )
        bind(
            surface,
            triangles_seen=frame.targets["triangles"],
            fine_from_pixel=tuple(frame.grid.fine_from_pixel.T.ravel()),
            first=tuple(first),
            last=tuple(size - 1),
            instances=frame.tables["placement"].table,
            material_table=frame.tables["surfaces"].table,
            texels=frame.tables["surfaces"].texels.texture,
            **frame.tables["geometry"].arrays,
            **({"uvs": frame.tables["coordinates"].uvs.array} if images else {}),
        )
        target = frame.targets.into("depth", "position", "normal", "albedo", "triangle")
        self.draw_tiles(frame, target, surface)

    def draw_triangles(self, frame: Frame) -> None:
        """Which triangle of which instance is nearest; 0 where there is none."""
        gl, size = frame.device.gl, tuple(map(int, frame.grid.bounds(frame.view.width, frame.view.height)[1]))
        room = np.minimum(frame.grid.room(frame.view.width, frame.view.height), self.device.texture_size)
        for name in ("triangles", "z"):
            frame.targets.reserve(name, self.writes[name], tuple(map(int, room)))
        target = frame.targets.into("triangles", "z")
        target.clear(depth=0.0, viewport=(0, 0, *size))
        most = self.device.texture_size  # viewports may be as large
        beyond = [min(math.ceil(GUARD_BAND * side), (most - side) // 2) for side in size]
        target.viewport = *np.negative(beyond), *np.add(size, np.multiply(2, beyond))
        target.use()
        gl.enable_only(moderngl.DEPTH_TEST)
        turn, shift = frame.grid.fine_from_clip(frame.view.width, frame.view.height)
        part = np.divide(size, target.viewport[2:])
        placement = frame.tables["placement"]
        bind(
            self.triangles,
            turn=tuple((part[:, None] * turn).T.ravel()),
            shift=tuple(part * shift),
            depth=(nearness if self.device.reversed_depth else logarithm)(frame.view.clip_from_view),
            corners=frame.tables["geometry"].arrays["corners"],
            instances=placement.table,
            owners=placement.owners.array,
        )
        triangles = gl.vertex_array(self.triangles, [])
        if frame.settings.shortcuts:
            a_pixel = 2.0 / min(frame.view.width, frame.view.height)
            draws = placement.draws(clip_from_anchor(frame.view, frame.anchor), a_pixel)
        else:
            draws = placement.chosen(np.ones(len(placement.mesh), np.bool_))
        waiting = 0
        for draw in portions(draws, TRIANGLES_AT_A_TIME):
            together = isinstance(draw, MultiDrawCall)
            bind(self.triangles, together=together)
            if together:
                count = int(draw.triangles.sum())
                self.device.draw_ranges(triangles, draw.first_triangle, draw.triangles)
            else:
                count = draw.triangles * draw.instances
                bind(self.triangles, first_instance=draw.first_instance)
                self.device.draw(triangles, draw.first_triangle, draw.triangles, draw.instances)
            frame.counts["triangles_drawn"] += count
            waiting += count
            if waiting >= TRIANGLES_AT_A_TIME:
                frame.pace.submit()
                waiting = 0
