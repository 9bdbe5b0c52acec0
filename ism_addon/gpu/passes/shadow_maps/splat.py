# SPDX-License-Identifier: GPL-3.0-or-later
"""An imperfect shadow map for each light point: surface points as oriented discs, nearest first.

Beck-Norén & Valter 2013, sections 2.1 and 3.2: a surface point is drawn as a square in which the fragment shader
cuts out a disc with the triangle's normal. Their squares come from a geometry shader; ours are OpenGL's points, 1.6
to 2 times as fast on llvmpipe. A map covers its light point's whole hemisphere, here by the upper half of an
octahedron, which wastes no texel. As that bends planes, each fragment meets the disc's plane itself. All maps lie in
one atlas; the nearest distance wins by blending with the minimum, which keeps metres. A disc wider than the driver's
largest point (llvmpipe: 255 texels) is cut to that. Maps of half as many texels are spared; in larger ones it meets
the discs close to the light.
"""

from functools import cached_property
from typing import Any

import moderngl
import numpy as np

from ...atlas import NO_OCCLUDER
from ...frame import Frame, Pass
from ...gl.draw_limit import portions
from ...gl.render_targets import Target
from ...gl.shader_compiler import bind, compile_program

#: Rays in whose time processors are done with a disc: as many as are drawn at once take memory on them until then.
RAYS_PER_DISC = 4.0

#: Texels that are drawn in the time of a ray.
TEXELS = 30


class SplatMaps(Pass):
    """The atlas of one batch: for each direction, the distance to the nearest disc."""

    reads = ("map_points", "maps")
    writes = {"splats": Target(1, "f4", neutral=(NO_OCCLUDER,), divisor=0)}
    settings = (
        "shadow.method",
        "quality.map_size",
    )

    @cached_property
    def discs(self) -> moderngl.Program:
        return compile_program(self.device, f"{self.name_of()}.vert", f"{self.name_of()}.frag", empty=NO_OCCLUDER)

    def needed(self, frame: Frame) -> bool:
        return frame.splats and frame.batch.count > 0

    def draw(self, frame: Frame) -> None:
        gl, batch = frame.device.gl, frame.batch
        frame.targets.allocate("splats", self.writes["splats"], batch.size)
        atlas = frame.targets.into("splats")
        whole = atlas.viewport
        atlas.clear(NO_OCCLUDER)
        subsets, points = frame.tables["map_points"]
        if points is None:
            return
        atlas.use()
        gl.enable_only(moderngl.BLEND | moderngl.PROGRAM_POINT_SIZE)
        gl.blend_equation = moderngl.MIN
        bind(self.discs, side=batch.side)
        discs = gl.vertex_array(self.discs, [(points, "3f 3f 1f", "position", "normal", "radius")])
        try:
            for index in range(batch.count):
                turns = subsets[frame.tables["maps"][batch.first + index]["light"]]
                subset = turns[(batch.first + index + frame.sample) % len(turns)]
                if subset.count:
                    self.draw_map(frame, atlas, discs, index, subset)
        finally:
            atlas.viewport, atlas.scissor = whole, None
            gl.blend_equation = moderngl.FUNC_ADD

    def draw_map(
        self, frame: Frame, atlas: moderngl.Framebuffer, discs: moderngl.VertexArray, index: int, subset: Any
    ) -> None:
        """That of one of the batch's light points, of one subset of the discs."""
        batch = frame.batch
        point, corner = frame.tables["maps"][batch.first + index], batch.corner(index)
        atlas.viewport = atlas.scissor = (*corner, batch.side, batch.side)
        tangent, normal = point["tangent"], point["normal"]
        axes = np.stack([tangent, np.cross(normal, tangent), normal], 1)  # row by row: GLSL's columns
        bind(self.discs, light_point=point["position"], map_from_anchor=axes.ravel(), corner=corner)
        rays = RAYS_PER_DISC + subset.maps * batch.side**2 / subset.count / TEXELS
        for part in portions(subset.count, rays):
            count = part.stop - part.start
            frame.pace.ask(rays * count)
            discs.render(moderngl.POINTS, vertices=count, first=subset.first + part.start)
