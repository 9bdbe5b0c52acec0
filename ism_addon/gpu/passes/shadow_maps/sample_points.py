# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as random points on its triangles, each representing the same fraction of its area.

Beck-Norén & Valter 2013, section 3.2, after Ritschel et al. 2008: a triangle is chosen with probability in
proportion to its area, and a point uniformly on it. select_points chooses those that are drawn into a shadow map.
"""

from ....resources import POINT_CLOUD
from ....scene import Change
from ...frame import Frame, Pass, outputs
from .point_cloud import make_point_cloud

#: Points in the cloud for each point of a map, and the cloud's limit, unless a map has more. See `dev.py bench
#: constants` in docs/benchmarks.md.
POINTS_PER_MAP_POINT = 16
MAX_POINTS = 1 << 20


class SamplePoints(Pass):
    """Sample points on all surfaces that cast shadows."""

    inputs = Change.MESHES, Change.INSTANCES, "quality.map_points"
    outputs = outputs(POINT_CLOUD)

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows

    def execute(self, frame: Frame) -> None:
        per_map = frame.settings.quality.map_points
        count = max(per_map, min(POINTS_PER_MAP_POINT * per_map, MAX_POINTS))
        frame[POINT_CLOUD] = make_point_cloud(frame.scene, frame.anchor, count, frame.submission.check_cancelled)
