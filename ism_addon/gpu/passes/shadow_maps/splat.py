# SPDX-License-Identifier: GPL-3.0-or-later
"""An imperfect shadow map for each virtual light: the depth of surface points, drawn as oriented discs.

Beck-Norén & Valter 2013, sections 2.1 and 3.2: a surface point is drawn as a square in which the fragment shader
discards what is outside a disc with the triangle's normal. Their squares come from a geometry shader; ours are OpenGL's
points, 1.6 to 2 times as fast on llvmpipe. A map covers its virtual light's hemisphere by the upper half of an
octahedron, which uses every texel; that of parallel light is an orthographic projection. The octahedron does not keep
planes, so each fragment intersects its ray with the disc's plane. All maps are in one atlas; blending with the minimum
keeps the nearest distance, in metres. A disc wider than the driver's largest point (llvmpipe: 255 texels) is clipped to
that size. This cannot happen in maps with at most half as many texels a side; in larger ones it happens to discs close
to the light.
"""

from __future__ import annotations

import moderngl
import numpy as np

from ....resources import ATLAS_BATCH, MAP_POINTS, NO_OCCLUDER, SHADOW_MAP_SPLATS, SHADOW_MAP_VIEWS
from ....scene import Change
from ...frame import Frame, Pass, outputs
from ...gl.draw_limit import portions
from ...gl.shader_compiler import bind, compile_program

#: Cost of a disc in rays, see draw_limit. Software drivers keep all discs of a draw in memory until it is done.
RAYS_PER_DISC = 4.0

#: Texels that are drawn in the time of a ray.
MAP_TEXELS_PER_RAY = 30


class SplatMaps(Pass):
    """The atlas of one batch: for each direction, the distance to the nearest disc."""

    inputs = MAP_POINTS, SHADOW_MAP_VIEWS, ATLAS_BATCH, Change.SAMPLE
    outputs = outputs(SHADOW_MAP_SPLATS)

    def program(self, parallel: bool) -> moderngl.Program:
        """The program for maps of parallel light, or of hemispheres."""
        names = f"{self.shader_name()}.vert", f"{self.shader_name()}.frag"
        return compile_program(self.device, *names, empty=NO_OCCLUDER, parallel=int(parallel))

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
        self.device.enable_only(moderngl.BLEND | moderngl.PROGRAM_POINT_SIZE)
        gl.blend_equation = moderngl.MIN  # type: ignore[assignment] # typed as two values, accepts one
        is_parallel = frame[SHADOW_MAP_VIEWS]["map_radius"][batch.first : batch.first + batch.count] > 0.0
        try:
            for parallel in np.unique(is_parallel).tolist():
                program = self.program(parallel)
                bind(program, side=batch.side)
                discs = gl.vertex_array(program, [(points.buffer, "3f 3f 1f", "position", "normal", "radius")])
                for index in np.flatnonzero(is_parallel == parallel).tolist():
                    self.draw_map(frame, atlas, discs, index)
        finally:
            atlas.viewport, atlas.scissor = full_viewport, None  # type: ignore[assignment] # accepts None
            gl.blend_equation = moderngl.FUNC_ADD  # type: ignore[assignment] # see above

    def draw_map(self, frame: Frame, atlas: moderngl.Framebuffer, discs: moderngl.VertexArray, index: int) -> None:
        """Draw the map of one of the batch's virtual lights from one subset of the points."""
        batch = frame[ATLAS_BATCH]
        view, corner = frame[SHADOW_MAP_VIEWS][batch.first + index], batch.corner(index)
        subsets = frame[MAP_POINTS].ranges[view["light"]]
        subset = subsets[(batch.first + index + frame.sample) % len(subsets)]
        if not subset.count:
            return
        atlas.viewport = atlas.scissor = (*corner, batch.side, batch.side)
        uniforms = {
            "origin": view["position"],
            "map_from_anchor": view["map_from_anchor"].T.ravel(),  # column-major, as in GLSL
            "map_radius": view["map_radius"],
            "corner": corner,
        }
        bind(discs.program, **uniforms)
        rays = RAYS_PER_DISC + subset.maps * batch.side**2 / subset.count / MAP_TEXELS_PER_RAY
        for portion in portions(subset.count, rays):
            count = portion.stop - portion.start
            frame.submission.before_draw(rays * count)
            discs.render(moderngl.POINTS, vertices=count, first=subset.first + portion.start)
