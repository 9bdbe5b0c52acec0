# SPDX-License-Identifier: GPL-3.0-or-later
"""Selects the surface points that represent the scene in the shadow maps of a light.

Ritschel et al. 2008 give each map a random subset of the points. Our subsets are importance sampled: the probability of
a point is in proportion to the solid angle of its area as seen from the light, and its disc has the area divided by the
probability. So all discs of a map have about the same solid angle, one covers about a texel if there are as many points
as texels, and surfaces near the light are drawn in detail (compare the view-adaptive maps of Ritschel et al. 2011). A
point keeps its random number, so that subsets change only where solid angles do. The virtual lights of a light use
several such subsets in turn.
"""

from collections.abc import Callable
from dataclasses import dataclass

import moderngl
import numpy as np

from ....parallel import parallel_map
from ....resources import CONTRIBUTING_LIGHTS, MAP_POINTS, POINT_CLOUD, RECEIVER_REGION
from ....sampling.dimensions import Dimension, draw
from ....sampling.point_cloud import PointCloud
from ....scene import Change, Lights
from ...culling.receiver_region import ReceiverRegion
from ...frame import Frame, Pass, outputs
from ...lights import type_of

#: Subsets of points for each light, which its virtual lights use in turn. See `dev.py bench constants` in
#: docs/benchmarks.md.
SUBSETS_PER_LIGHT = 4

MAP_POINT = np.dtype([("position", "f4", 3), ("normal", "f4", 3), ("radius", "f4")])


@dataclass(frozen=True)
class PointRange:
    """Vertices first … first + count - 1 of the buffer of points."""

    first: int
    count: int
    maps: float  # upper bound of the summed area of all discs, in maps


@dataclass(frozen=True)
class MapPoints:
    """The points of all lights' shadow maps."""

    ranges: list[list[PointRange]]  # by light, SUBSETS_PER_LIGHT each
    buffer: moderngl.Buffer | None  # rows of MAP_POINT; None without any


def solid_angles(
    cloud: PointCloud, lights: Lights, light: int, anchor: np.ndarray, region: ReceiverRegion | None = None
) -> np.ndarray:
    """(P,) float32: see LightType.solid_angles; 0 for points on objects that do not cast this light's shadows."""
    light_type = type_of(lights, light)
    angles = light_type.solid_angles(lights, light, anchor, cloud.positions, cloud.normals, cloud.area, region)
    blockers = lights.blockers[light]
    linked = True if blockers < 0 else cloud.groups >> np.uint32(blockers) & 1 == 1
    return np.where(linked, angles, np.float32(0.0))


def selection_probabilities(weights: np.ndarray, count: int) -> np.ndarray:
    """(P,) probabilities in proportion to weights (P,), at most 1, that sum to `count` if possible."""
    scale = count / max(float(weights.sum()), 1e-30)
    for _ in range(8):  # the excess of those clamped to 1 goes to the others
        clamped = weights * scale >= 1.0
        remaining = float(weights[~clamped].sum())
        if remaining <= 0.0:
            break
        scale = (count - int(clamped.sum())) / remaining
    return np.minimum(weights * np.float32(max(scale, 0.0)), np.float32(1.0))


def select_subsets(
    cloud: PointCloud,
    weights: np.ndarray,
    count: int,
    splat_size: float,
    check_cancelled: Callable[[], None] = lambda: None,
) -> list[np.ndarray]:
    """SUBSETS_PER_LIGHT subsets of about `count` points each, as arrays of MAP_POINT, by their weights (P,).

    `check_cancelled` is called before each.
    """
    probabilities = selection_probabilities(weights, count)
    uniform = draw(Dimension.POINT_CHOICE, point=np.arange(len(cloud)))[:, 0].astype(np.float32)
    subsets = []
    for subset in range(SUBSETS_PER_LIGHT):
        check_cancelled()
        selected = np.flatnonzero(np.modf(uniform + np.float32(subset / SUBSETS_PER_LIGHT))[0] < probabilities)
        points = np.zeros(len(selected), MAP_POINT)
        points["position"], points["normal"] = cloud.positions[selected], cloud.normals[selected]
        points["radius"] = splat_size * np.sqrt(cloud.area / np.pi / probabilities[selected])
        subsets.append(points)
    return subsets


def parallel_maps_filled(points: np.ndarray, region: ReceiverRegion) -> float:
    """Summed area, in maps, of the discs of MAP_POINTs (P,) in parallel light."""
    sides = np.minimum(points["radius"] / np.float32(region.radius), 1.0)
    return float((sides * sides).sum(dtype=np.float64))


def maps_filled(points: np.ndarray, light: np.ndarray) -> float:
    """Summed area, in maps, of the discs of MAP_POINTs (P,), as seen from a light's centre (3,).

    An upper bound of the texels that splat.vert draws: squares by the mapping's largest derivative, and the full map
    for a disc close by.
    """
    offset: np.ndarray = points["position"] - light.astype(np.float32)
    distance = np.sqrt(np.einsum("nk,nk->n", offset, offset))
    side = 2.0 * points["radius"] / np.maximum(distance, 2.0 * points["radius"])
    return float(np.minimum((side + side * side) ** 2, 1.0).sum(dtype=np.float64))


class SelectPoints(Pass):
    """Select the points of each light's shadow maps: a vertex buffer, and the range of each subset in it."""

    inputs = POINT_CLOUD, CONTRIBUTING_LIGHTS, RECEIVER_REGION, Change.LIGHTS, "quality.map_points", "shadow.splat_size"
    outputs = outputs(MAP_POINTS)

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows

    def execute(self, frame: Frame) -> None:
        cloud, lights, region = frame[POINT_CLOUD], frame.scene.lights, frame[RECEIVER_REGION]
        count, size = frame.settings.quality.map_points, frame.settings.shadow.splat_size
        check_cancelled, contributing = frame.submission.check_cancelled, frame[CONTRIBUTING_LIGHTS]

        def light_subsets(light: int) -> list[tuple[np.ndarray, float]]:
            if not lights.casts_shadow[light] or light not in contributing:
                return [(np.zeros(0, MAP_POINT), 0.0)] * SUBSETS_PER_LIGHT
            weights = solid_angles(cloud, lights, light, frame.anchor, region)
            subsets = select_subsets(cloud, weights, count, size, check_cancelled)
            if region is not None and type_of(lights, light).parallel:
                return [(points, parallel_maps_filled(points, region)) for points in subsets]
            return [(points, maps_filled(points, lights.position[light] - frame.anchor)) for points in subsets]

        of_lights = parallel_map(light_subsets, range(len(lights.shape)), len(lights.shape) * len(cloud))
        check_cancelled()
        points = np.concatenate([subset for subsets in of_lights for subset, _ in subsets])
        ends = np.cumsum([len(subset) for subsets in of_lights for subset, _ in subsets]).reshape(-1, SUBSETS_PER_LIGHT)
        table = [
            [
                PointRange(int(end) - len(points), len(points), maps)
                for end, (points, maps) in zip(row, subsets, strict=True)
            ]
            for row, subsets in zip(ends, of_lights, strict=True)
        ]
        check_cancelled()
        buffer: moderngl.Buffer | None = self.device.gl.buffer(points) if len(points) else None
        frame[MAP_POINTS] = MapPoints(table, buffer)
        frame.counts["bytes_uploaded"] += points.nbytes
        frame.counts["map_points"] = max((subset.count for row in table for subset in row), default=0)
