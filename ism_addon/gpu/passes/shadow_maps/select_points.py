# SPDX-License-Identifier: GPL-3.0-or-later
"""Which surface points stand for the scene in the shadow maps of a light.

Ritschel et al. 2008 give each map a random subset of the points. We choose those by what a map can show of them: a
point is taken with a probability in proportion to the solid angle that its share of area fills as seen from the
light, and then stands for as many times more area. So all discs of a map are about as large, one covers about one
texel where there are as many points as texels, and what is near the light is drawn finely (compare the
view-adaptive maps of Ritschel et al. 2011). A point's chance is its own and fixed: subsets change only where
the light's view of them does. Light points take turns with several such subsets.
"""

from collections.abc import Callable
from dataclasses import dataclass

import moderngl
import numpy as np

from ....parallel import parallel_map
from ....resources import CONTRIBUTING_LIGHTS, MAP_POINTS, POINT_CLOUD
from ....sampling.dimensions import Dimension, draw
from ....scene import Change, Lights
from ...frame import Frame, Pass, outputs
from ...lights import type_of
from .point_cloud import PointCloud

#: Subsets a light; its light points share them out.
SUBSETS_PER_LIGHT = 4

MAP_POINT = np.dtype([("position", "f4", 3), ("normal", "f4", 3), ("radius", "f4")])


@dataclass(frozen=True)
class PointRange:
    """Vertices first … first + count - 1 of the buffer of points."""

    first: int
    count: int
    maps: float  # that all discs would fill if none hid another, at most


@dataclass(frozen=True)
class MapPoints:
    """The points of all lights' shadow maps."""

    ranges: list[list[PointRange]]  # by light, SUBSETS_PER_LIGHT each
    buffer: moderngl.Buffer | None  # rows of MAP_POINT; None without any


def solid_angles(cloud: PointCloud, lights: Lights, light: int, anchor: np.ndarray) -> np.ndarray:
    """(P,) float32: see LightType.solid_angles; 0 for points that are not linked."""
    light_type = type_of(lights, light)
    found = light_type.solid_angles(lights, light, anchor, cloud.positions, cloud.normals, cloud.area)
    blockers = lights.blockers[light]
    linked = True if blockers < 0 else cloud.groups >> np.uint32(blockers) & 1 == 1
    return np.where(linked, found, np.float32(0.0))


def selection_probabilities(weights: np.ndarray, count: int) -> np.ndarray:
    """(P,) probabilities in proportion to weights (P,), no more than 1, that sum to `count` if they can."""
    scale = count / max(float(weights.sum()), 1e-30)
    for _ in range(8):  # what is cut off at 1 is given to the others
        full = weights * scale >= 1.0
        rest = float(weights[~full].sum())
        if rest <= 0.0:
            break
        scale = (count - int(full.sum())) / rest
    return np.minimum(weights * np.float32(max(scale, 0.0)), np.float32(1.0))


def select(
    cloud: PointCloud,
    weights: np.ndarray,
    count: int,
    splat_size: float,
    look: Callable[[], None] = lambda: None,
) -> list[np.ndarray]:
    """SUBSETS_PER_LIGHT subsets of about `count` points for a light of weights (P,), as arrays of MAP_POINT.

    Before each it calls `look`.
    """
    chance = selection_probabilities(weights, count)
    luck = draw(Dimension.POINT_CHOICE, point=np.arange(len(cloud)))[:, 0].astype(np.float32)
    found = []
    for turn in range(SUBSETS_PER_LIGHT):
        look()
        taken = np.flatnonzero(np.modf(luck + np.float32(turn / SUBSETS_PER_LIGHT))[0] < chance)
        points = np.zeros(len(taken), MAP_POINT)
        points["position"], points["normal"] = cloud.positions[taken], cloud.normals[taken]
        points["radius"] = splat_size * np.sqrt(cloud.area / np.pi / chance[taken])
        found.append(points)
    return found


def maps_filled(points: np.ndarray, light: np.ndarray) -> float:
    """How many maps the discs of MAP_POINTs (P,) would fill if none hid another, seen from a light's middle (3,).

    That is what splat.vert draws: squares, where maps stretch them most, and all of the map for a disc close by.
    """
    to: np.ndarray = points["position"] - light.astype(np.float32)
    distance = np.sqrt(np.einsum("nk,nk->n", to, to))
    side = 2.0 * points["radius"] / np.maximum(distance, 2.0 * points["radius"])
    return float(np.minimum((side + side * side) ** 2, 1.0).sum(dtype=np.float64))


class SelectPoints(Pass):
    """A vertex buffer of all subsets, and where each light's lie in it."""

    inputs = POINT_CLOUD, CONTRIBUTING_LIGHTS, Change.LIGHTS, "quality.map_points", "shadow.splat_size"
    outputs = outputs(MAP_POINTS)

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows

    def execute(self, frame: Frame) -> None:
        cloud, lights = frame[POINT_CLOUD], frame.scene.lights
        count, size = frame.settings.quality.map_points, frame.settings.shadow.splat_size
        look, contributing = frame.submission.check_cancelled, frame[CONTRIBUTING_LIGHTS]

        def of_light(light: int) -> list[tuple[np.ndarray, float]]:
            if not lights.casts_shadow[light] or light not in contributing:
                return [(np.zeros(0, MAP_POINT), 0.0)] * SUBSETS_PER_LIGHT
            subsets = select(cloud, solid_angles(cloud, lights, light, frame.anchor), count, size, look)
            return [(points, maps_filled(points, lights.position[light] - frame.anchor)) for points in subsets]

        chosen = parallel_map(of_light, range(len(lights.shape)), len(lights.shape) * len(cloud))
        look()
        points = np.concatenate([subset for subsets in chosen for subset, _ in subsets])
        ends = np.cumsum([len(subset) for subsets in chosen for subset, _ in subsets]).reshape(-1, SUBSETS_PER_LIGHT)
        table = [
            [
                PointRange(int(end) - len(points), len(points), maps)
                for end, (points, maps) in zip(row, subsets, strict=True)
            ]
            for row, subsets in zip(ends, chosen, strict=True)
        ]
        look()
        buffer: moderngl.Buffer | None = self.device.gl.buffer(points) if len(points) else None
        frame[MAP_POINTS] = MapPoints(table, buffer)
        frame.counts["bytes_uploaded"] += points.nbytes
        frame.counts["map_points"] = max((subset.count for row in table for subset in row), default=0)
