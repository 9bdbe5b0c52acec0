# SPDX-License-Identifier: GPL-3.0-or-later
"""An imperfect shadow map for each virtual light: the depth of surface points, drawn as oriented discs.

Beck-Norén & Valter 2013, sections 2.1 and 3.2: a surface point is drawn as a square in which the fragment shader
discards what is outside a disc with the triangle's normal. Their squares come from a geometry shader; ours are OpenGL's
points, 1.6 to 2 times as fast on llvmpipe. A map covers its virtual light's hemisphere by the upper half of an
octahedron, which uses every texel. The mapping does not keep planes, so each fragment intersects its ray with the
disc's plane. All maps are in one atlas; blending with the minimum keeps the nearest distance, in metres. A disc wider
than the driver's largest point (llvmpipe: 255 texels) is clipped to that size. This cannot happen in maps with at most
half as many texels a side; in larger ones it happens to discs close to the light.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import moderngl

from ....resources import ATLAS_BATCH, MAP_POINTS, NO_OCCLUDER, SHADOW_MAP_SPLATS, SHADOW_MAP_VIEWS
from ....scene import Change
from ...frame import Frame, Pass, outputs
from ...gl.draw_limit import portions
from ...gl.shader_compiler import bind, compile_program

if TYPE_CHECKING:
    from .select_points import PointRange

#: Cost of a disc in rays, see draw_limit. Software drivers keep all discs of a draw in memory until it is done.
RAYS_PER_DISC = 4.0

#: Texels that are drawn in the time of a ray.
MAP_TEXELS_PER_RAY = 30


class SplatMaps(Pass):
    """The atlas of one batch: for each direction, the distance to the nearest disc."""

    inputs = MAP_POINTS, SHADOW_MAP_VIEWS, ATLAS_BATCH, Change.SAMPLE
    outputs = outputs(SHADOW_MAP_SPLATS)

    @cached_property
    def discs(self) -> moderngl.Program:
        return compile_program(
            self.device, f"{self.shader_name()}.vert", f"{self.shader_name()}.frag", empty=NO_OCCLUDER
        )

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows and frame[ATLAS_BATCH].count > 0

    def execute(self, frame: Frame) -> None:
        gl, batch, points = frame.device.gl, frame[ATLAS_BATCH], frame[MAP_POINTS]
        frame.allocate(SHADOW_MAP_SPLATS, batch.size)
        atlas = frame.framebuffer(SHADOW_MAP_SPLATS)
        full_viewport = atlas.viewport
        atlas.clear(NO_OCCLUDER)
        if points.buffer is None:
            return
        atlas.use()
        gl.enable_only(moderngl.BLEND | moderngl.PROGRAM_POINT_SIZE)
        gl.blend_equation = moderngl.MIN  # type: ignore[assignment] # typed as two values, accepts one
        bind(self.discs, side=batch.side)
        discs = gl.vertex_array(self.discs, [(points.buffer, "3f 3f 1f", "position", "normal", "radius")])
        try:
            for index in range(batch.count):
                subsets = points.ranges[frame[SHADOW_MAP_VIEWS][batch.first + index]["light"]]
                subset = subsets[(batch.first + index + frame.sample) % len(subsets)]
                if subset.count:
                    self.draw_map(frame, atlas, discs, index, subset)
        finally:
            atlas.viewport, atlas.scissor = full_viewport, None  # type: ignore[assignment] # accepts None
            gl.blend_equation = moderngl.FUNC_ADD  # type: ignore[assignment] # see above

    def draw_map(
        self, frame: Frame, atlas: moderngl.Framebuffer, discs: moderngl.VertexArray, index: int, subset: PointRange
    ) -> None:
        """Draw the map of one of the batch's virtual lights from one subset of the points."""
        batch = frame[ATLAS_BATCH]
        view, corner = frame[SHADOW_MAP_VIEWS][batch.first + index], batch.corner(index)
        atlas.viewport = atlas.scissor = (*corner, batch.side, batch.side)
        rotation = view["map_from_anchor"].T.ravel()  # column-major, as in GLSL
        bind(self.discs, virtual_light=view["position"], map_from_anchor=rotation, corner=corner)
        rays = RAYS_PER_DISC + subset.maps * batch.side**2 / subset.count / MAP_TEXELS_PER_RAY
        for portion in portions(subset.count, rays):
            count = portion.stop - portion.start
            frame.submission.before_draw(rays * count)
            discs.render(moderngl.POINTS, vertices=count, first=subset.first + portion.start)
