# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as random points on its triangles, each standing for the same share of its area.

Beck-Norén & Valter 2013, section 3.2, after Ritschel et al. 2008: a triangle is chosen with probability in
proportion to its area, a point uniformly on it. Which of the points a shadow map sees, subsets decides.
"""

from ....resources import POINT_CLOUD
from ....scene import Change
from ...frame import Frame, Pass, outputs
from .point_cloud import make_point_cloud

#: Points in the cloud for each that a map sees, and the most points in the cloud, whatever a map sees.
POINTS_PER_MAP_POINT = 16
MAX_POINTS = 1 << 20


class SamplePoints(Pass):
    """The cloud that stands for the scene."""

    inputs = Change.MESHES, Change.INSTANCES, "quality.map_points"
    outputs = outputs(POINT_CLOUD)

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows

    def execute(self, frame: Frame) -> None:
        seen = frame.settings.quality.map_points
        count = max(seen, min(POINTS_PER_MAP_POINT * seen, MAX_POINTS))
        frame[POINT_CLOUD] = make_point_cloud(frame.scene, frame.anchor, count, frame.submission.check_cancelled)
