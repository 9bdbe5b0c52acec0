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
from ...drawing import evaluate_points
from ...frame import Frame, Pass, outputs
from ...materials.point_graphs import NO_POINT_GRAPHS, OPAQUE

#: Points in the cloud for each point of a map, and the cloud's limit, unless a map has more. See `dev.py bench
#: constants` in docs/benchmarks.md.
POINTS_PER_MAP_POINT = 16
MAX_POINTS = 1 << 20


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
        triangles = meshes.rows_of(frame.scene.instances.mesh[cloud.instances], cloud.triangles)
        table = np.zeros((len(cloud), 8), np.uint32)
        table[:, :3], table[:, 3] = cloud.positions.view(np.uint32), triangles.clip(0)
        table[:, 4:7] = cloud.normals.view(np.uint32)
        table[:, 7] = frame[INSTANCE_BUFFERS].rows[cloud.instances].clip(0)
        shader, corners = self.full_screen_program(*surfaces.parts, **surfaces.constants), meshes.samplers["corners"]
        passes = evaluate_points(frame, shader, table, 1, corners=corners, **surfaces.uniforms)[:, 0]
        return np.where(triangles < 0, np.float32(0.0), passes)
