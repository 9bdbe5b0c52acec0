# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as random points on its triangles, each representing the same fraction of its area.

Beck-Norén & Valter 2013, section 3.2, after Ritschel et al. 2008: a triangle is chosen with probability in
proportion to its area, and a point uniformly on it. select_points chooses those that are drawn into a shadow map.
"""

import numpy as np

from ....resources import INSTANCE_BUFFERS, MESH_BUFFERS, POINT_CLOUD, POINT_GRAPHS
from ....sampling.dimensions import Dimension, draw
from ....sampling.point_cloud import PointCloud, make_point_cloud
from ....scene import Change
from ...buffers.mesh_buffers import MeshBuffers
from ...drawing import draw_pixels
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind, compile_program
from ...materials.point_graphs import NO_POINT_GRAPHS, OPAQUE

#: Points in the cloud for each point of a map, and the cloud's limit, unless a map has more. See `dev.py bench
#: constants` in docs/benchmarks.md.
POINTS_PER_MAP_POINT = 16
MAX_POINTS = 1 << 20


#: Columns of the picture of all points, so that it is within OpenGL's limits.
COLUMNS = 1024


class SamplePoints(Pass):
    """Sample points on all surfaces that cast shadows; on transparent ones, as many as they occlude light."""

    inputs = (
        *(Change.MESHES, Change.INSTANCES, "quality.map_points"),
        *(POINT_GRAPHS, MESH_BUFFERS, INSTANCE_BUFFERS),
    )
    outputs = outputs(POINT_CLOUD)

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows

    def execute(self, frame: Frame) -> None:
        per_map = frame.settings.quality.map_points
        count = max(per_map, min(POINTS_PER_MAP_POINT * per_map, MAX_POINTS))
        cloud = make_point_cloud(frame.scene, frame.anchor, count, frame.submission.check_cancelled)
        if (frame.get(POINT_GRAPHS) or NO_POINT_GRAPHS).points is not OPAQUE and len(cloud):
            random = draw(Dimension.POINT_TRANSPARENCY, point=np.arange(len(cloud)))[:, 0]
            cloud = cloud.only(random >= self.passing(frame, cloud))
        frame[POINT_CLOUD] = cloud

    def passing(self, frame: Frame, cloud: PointCloud) -> np.ndarray:
        """(P,) the fraction of light that passes at each point; 0 on meshes that are not resident."""
        surfaces, meshes = frame[POINT_GRAPHS].points, frame[MESH_BUFFERS]
        triangles = buffer_triangles(meshes, frame.scene.instances.mesh[cloud.instances], cloud.triangles)
        rows = -(-len(cloud) // COLUMNS)
        table = np.zeros((rows * COLUMNS, 8), np.uint32)
        table[: len(cloud), :3], table[: len(cloud), 3] = cloud.positions.view(np.uint32), triangles.clip(0)
        table[: len(cloud), 4:7] = cloud.normals.view(np.uint32)
        table[: len(cloud), 7] = frame[INSTANCE_BUFFERS].rows[cloud.instances].clip(0)
        stages = "glsl/full_screen.vert", f"{self.shader_name()}.frag"
        records, constants = surfaces.records, surfaces.constants
        program = compile_program(self.device, *stages, *surfaces.includes, records=records, **constants)
        texture = self.device.gl.texture((COLUMNS, rows), 1, dtype="f4")
        target = self.device.gl.framebuffer([texture])
        self.device.overwrite()
        bind(
            program,
            points=self.device.buffer_from(table.reshape(-1, 4)),
            columns=COLUMNS,
            corners=meshes.samplers["corners"],
            **surfaces.uniforms,
        )
        draw_pixels(frame, target, self.device.gl.vertex_array(program, []))
        passes = np.frombuffer(texture.read(), np.float32)[: len(cloud)]
        return np.where(triangles < 0, np.float32(0.0), passes)


def buffer_triangles(buffers: MeshBuffers, mesh: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(P,) indices in the buffers of meshes' (P,) triangles, of these (P,) indices in the meshes; -1: not resident."""
    result = np.full(len(mesh), -1)
    for k in np.unique(mesh).tolist():
        if buffers.first_triangle[k] < 0:
            continue
        chosen, blas = mesh == k, buffers.blases[k]
        own = triangles[chosen]
        if blas is not None and blas.order is not None:
            own = np.argsort(blas.order)[own]
        result[chosen] = buffers.first_triangle[k] + own
    return result
