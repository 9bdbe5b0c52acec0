# SPDX-License-Identifier: GPL-3.0-or-later
"""Penumbrae past an edge against numerical integrals, for each type of light, from one sample to thousands."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial, reduce

import numpy as np
import pytest

from ism_addon.gpu.passes.film.accumulate import RELATIVE_VARIANCE
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import Lights, LightShape, Scene, View
from tests.stress.pictures.test_closed_forms import BRDF, UP, pixel_positions
from tests.support import reference_irradiance
from tests.support.emission import spot_attenuation
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    join_lights,
    light,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)

SAMPLE_COUNTS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 64, 96, 128, 256, 512, 1024, 2048)


def irradiance_past_edge(x: float, y: float, across: np.ndarray) -> float:
    """Irradiance at (x, y, 0) by a square light at z = 2 that is partly hidden by a half-plane at z = 1.

    The half-plane's edge is over the origin; `across` (2,) is perpendicular to the edge and points to its open side.
    """
    corners = [np.array(corner) for corner in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))]
    side, visible = [corner @ across + across @ (x, y) for corner in corners], []
    for k in range(4):
        if side[k] >= 0.0:
            visible.append(corners[k])
        if (side[k] >= 0.0) != (side[k - 3] >= 0.0):
            visible.append(corners[k] + (corners[k - 3] - corners[k]) * side[k] / (side[k] - side[k - 3]))
    polygon = np.array([(*(corner - (x, y)), 2.0) for corner in visible])
    return abs(reference_irradiance.edge_sum(polygon, UP)) if len(visible) > 2 else 0.0


def square_past_edge(view: View, across: np.ndarray) -> tuple[np.ndarray, float]:
    """(H,W) irradiance of a view's pixels by a square light past the edge; and without it: see irradiance_past_edge."""
    axis = pixel_positions(1.0, view.width)
    unshadowed = reference_irradiance.irradiance(np.zeros(3), UP, light())
    return np.array([[irradiance_past_edge(x, y, across[:2]) for x in axis] for y in axis]), unshadowed


#: Nodes and weights of Gauss-Legendre quadrature on [-1, 1].
NODES, NODE_WEIGHTS = np.polynomial.legendre.leggauss(16)


def cut_cap(axis: np.ndarray, sine: float, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The part of a cap on the side of a plane to which `normal` (3,) points: directions (N,3), solid angles (N,).

    In the gnomonic projection around the cap's axis it is a disc cut by a straight line.
    """
    tangent, radius = normal - axis * (normal @ axis), sine / math.sqrt(1.0 - sine**2)
    length = float(np.linalg.norm(tangent))
    first = math.asin(float(np.clip(-(normal @ axis) / (length * radius), -1.0, 1.0)))
    half = 0.5 * (math.pi / 2.0 - first)
    angle = first + half * (NODES[:, None] + 1.0)  # along the circle, to a chord parallel to the line
    x, chord = radius * np.sin(angle), radius * np.cos(angle)
    y, areas = chord * NODES, half * chord**2 * NODE_WEIGHTS[:, None] * NODE_WEIGHTS
    directions = axis + (x * tangent[:, None, None] + y * np.cross(axis, tangent)[:, None, None]).T / length
    squares = 1.0 + x**2 + y**2
    return (directions / np.sqrt(squares.T)[..., None]).reshape(-1, 3), (areas / squares**1.5).T.ravel()


def cap_past_edge(one: Lights, view: View, across: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same by a sphere, a spot or a sun."""
    axis, result = pixel_positions(1.0, view.width), np.zeros((2, view.height, view.width))
    for row, column in np.ndindex(result.shape[1:]):
        point = np.array([axis[column], axis[row], 0.0])
        distance, sine, to = 1.0, math.sin(one.spread[0] / 2.0), -one.normal[0]
        if one.shape[0] != LightShape.SUN:
            distance = float(np.linalg.norm(one.position[0] - point))
            sine, to = one.radius[0] / distance, (one.position[0] - point) / distance
        past = across + UP * (across @ point)  # normal of the plane through the point and the half-plane's edge
        for which, normal in enumerate((past, -past)):
            directions, solid_angles = cut_cap(to, sine, normal)
            weight = directions[:, 2] * solid_angles / (math.pi * sine**2 * distance**2)
            if one.shape[0] == LightShape.SPOT:
                weight *= spot_attenuation(-directions, one, 0)
            result[which, row, column] = weight.sum()
    return result[0], result.sum(0)


def filtered(picture: np.ndarray, view: View) -> np.ndarray:
    """(H,W), smoothed as much as by the view's pixel filter, see film/accumulate.py: three taps along each axis."""
    side = 0.5 * view.filter_width**2 / 12.0 / RELATIVE_VARIANCE
    for _ in range(2):
        padded = np.pad(picture, ((1, 1), (0, 0)), mode="edge")
        picture = (picture + side * (padded[2:] - 2.0 * picture + padded[:-2])).T
    return picture


SPHERE = light(LightShape.POINT, radius=0.5)
SPOT = light(LightShape.SPOT, radius=0.5, spread=1.0, blend=0.5)
SUN = light(LightShape.SUN, axis_v=(0.0, -0.94, 0.34), spread=0.5)
#: By name: a light, and its irradiance of a view's pixels past an edge, and without the edge.
PENUMBRAE: dict[str, tuple[Lights, Callable[[View, np.ndarray], tuple[np.ndarray, np.ndarray | float]]]] = {
    "square": (light(), square_past_edge),
    "sphere": (SPHERE, partial(cap_past_edge, SPHERE)),
    "spot": (SPOT, partial(cap_past_edge, SPOT)),
    "sun": (SUN, partial(cap_past_edge, SUN)),
}


#: Angles of edges, side by side in one picture, and its pixels: those compared of each edge, and half of those between.
EDGES = np.radians([0.0, 33.0, 90.0])
EDGE_PIXELS, MARGIN = 40, 2


def edges(one: Lights) -> tuple[Scene, View]:
    """The light past an edge of each of these angles, and its picture from above. Each light sees its edge only.

    The compared pixels of each are 1 m wide.
    """
    pitch = (EDGE_PIXELS + 2 * MARGIN) / EDGE_PIXELS  # m
    meshes, lights = [], []
    for index, angle in enumerate(EDGES):
        offset = np.array([(index - 0.5 * (len(EDGES) - 1)) * pitch, 0.0, 0.0])
        across = np.array([math.cos(angle), math.sin(angle), 0.0])
        along = np.array([-math.sin(angle), math.cos(angle), 0.0])
        corner_of_plate = offset + UP - 4.0 * across - 4.0 * along
        meshes += [
            quad(offset - (0.5 * pitch, 0.5 * pitch, 0.0), (pitch, 0, 0), (0, pitch, 0)),
            quad(corner_of_plate, 4.0 * across, 8.0 * along),
        ]
        group = np.array([index], np.int32)
        lights.append(replace(one, position=one.position + offset, receivers=group, blockers=group))
    scene = make_scene(meshes, reduce(join_lights, lights))
    groups = (1 << np.arange(len(EDGES), dtype=np.uint32)).repeat(2)
    scene = replace(
        scene, instances=replace(scene.instances, visible=np.tile([True, False], len(EDGES)), groups=groups)
    )
    height = EDGE_PIXELS + 2 * MARGIN
    return scene, view_from_above(len(EDGES) * pitch, (len(EDGES) * height, height), filter_width=1.5)


@pytest.mark.parametrize("name", PENUMBRAE)
def test_penumbrae_converge_without_bias(device, assert_within, name):
    """The error at edges of any angle falls as that of randomised quasi-Monte Carlo, and no bias is left.

    On caps of directions samples are less even than on a square.
    """
    (one, irradiance), is_square = PENUMBRAE[name], name == "square"
    scene, view = edges(one)
    of_edge = view_from_above(1.0, (EDGE_PIXELS, EDGE_PIXELS), filter_width=1.5)
    expected = []
    for angle in EDGES:
        visible, unshadowed = irradiance(of_edge, np.array([math.cos(angle), math.sin(angle), 0.0]))
        brightest, fraction = np.max(unshadowed), visible / unshadowed
        expected.append((filtered(visible, of_edge) / brightest, (fraction > 0.02) & (fraction < 0.98), brightest))
    renderer, profile, settings = Renderer(device), Profile(), with_quality(SMALL_SETTINGS, samples=SAMPLE_COUNTS[-1])
    for sample in range(SAMPLE_COUNTS[-1]):
        for _ in renderer.sample(scene, view, settings, sample, profile):
            pass
        if sample + 1 in SAMPLE_COUNTS:
            pictures = np.split(renderer.picture()[..., 0], len(EDGES), 1)
            for picture, (truth, penumbra, brightest) in zip(pictures, expected, strict=True):
                compared = picture[MARGIN:-MARGIN, MARGIN:-MARGIN] / (BRDF * brightest)
                error = (compared - truth)[penumbra]
                root_mean_square = float(np.sqrt((error**2).mean()))
                assert_within(root_mean_square * (sample + 1) ** 0.65, 0.2 if is_square else 0.32)
                if sample + 1 == SAMPLE_COUNTS[-1]:
                    assert_within(root_mean_square, 0.0016)
                    assert_within(abs(float(error.mean())), 0.0003)
